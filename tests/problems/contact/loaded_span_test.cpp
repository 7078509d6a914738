// When a foot is on the floor, from a force with noise.
#include "problems/contact/motion/loaded_span.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace sinew {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<double> Times(std::size_t count) {
  std::vector<double> time;
  for (std::size_t i = 0; i < count; ++i) time.push_back(static_cast<double>(i));
  return time;
}

TEST(LoadedSpan, LastsWhileTheForceExceedsTwoPercent) {
  const std::vector<double> force{0, 1, 3, 8, 100, 60, 100, 8, 3, 1, 0};
  const auto span = LoadedSpan(Times(force.size()), force, 0, 10, 0);
  ASSERT_TRUE(span);
  EXPECT_EQ((*span)[0], 2);
  EXPECT_EQ((*span)[1], 8);
}

TEST(LoadedSpan, DoesNotGrowByNoiseBesideTheStance) {
  const std::vector<double> force{4, 0, 3, 8, 100, 100, 8, 1, 3, -4, 4};
  const auto unknown = LoadedSpan(Times(force.size()), force, 0, 10, 0);
  ASSERT_TRUE(unknown);
  EXPECT_EQ((*unknown)[0], 2) << "4 is less than 5 % of 100";
  EXPECT_EQ((*unknown)[1], 6);
  const auto noisy = LoadedSpan(Times(force.size()), force, 0, 10, 3);
  ASSERT_TRUE(noisy);
  EXPECT_EQ((*noisy)[0], 2) << "8 is no more than noise, and connected with 100";
  EXPECT_EQ((*noisy)[1], 6);
}

TEST(LoadedSpan, HoldsAcrossAMomentWithoutLoad) {
  const std::vector<double> force{0, 50, 0, kNan, 0, 100, 0};
  const auto span = LoadedSpan(Times(force.size()), force, 0, 6, 1);
  ASSERT_TRUE(span);
  EXPECT_EQ((*span)[0], 1);
  EXPECT_EQ((*span)[1], 5);
}

TEST(LoadedSpan, IsNothingWithoutTwoLoadedSamples) {
  EXPECT_FALSE(LoadedSpan({}, {}, 0, 1, 0));
  EXPECT_FALSE(LoadedSpan(Times(3), {0, 100, 0}, 0, 2, 0));
  EXPECT_FALSE(LoadedSpan(Times(3), {kNan, kNan, kNan}, 0, 2, 0));
  EXPECT_FALSE(LoadedSpan(Times(3), {1, 2, 1}, 0, 2, 1)) << "noise alone";
  EXPECT_FALSE(LoadedSpan(Times(4), {100, 100, 0, 0}, 2, 3, 0)) << "not within the times asked for";
}

}  // namespace
}  // namespace sinew
