#include "problems/emg_shape/bursts.h"

#include <gtest/gtest.h>

#include <cmath>

#include "problems/emg_shape/cycle_scatter.h"

namespace sinew {
namespace {

// Bursts of these sizes and places on a floor.
Vector Curve(const std::vector<std::pair<double, double>>& bursts) {
  Vector curve = Vector::Constant(100, 0.02);
  for (int i = 0; i < 100; ++i) {
    for (const auto& [size, place] : bursts) {
      const double away = std::remainder(0.01 * i - place, 1.0) / 0.07;
      curve[i] += size * std::exp(-0.5 * away * away);
    }
  }
  return curve;
}

TEST(Bursts, CutsLieBetweenThem) {
  const auto one = FindCuts(Curve({{0.5, 0.3}}));
  ASSERT_EQ(one.size(), 1U);
  EXPECT_NEAR(one[0], 0.8, 0.02);
  const auto two = FindCuts(Curve({{0.5, 0.2}, {0.1, 0.7}}));
  ASSERT_EQ(two.size(), 2U);
  EXPECT_LT(two[0], 0.02 + 0.5);
  EXPECT_GT(two[0], 0.38);
  EXPECT_GT(two[1], 0.9);
  // A bump of 1 % is none; over the cycle's end a burst is one.
  EXPECT_EQ(FindCuts(Curve({{0.5, 0.2}, {0.005, 0.7}})).size(), 1U);
  EXPECT_EQ(FindCuts(Curve({{0.5, 0.99}, {0.3, 0.5}})).size(), 2U);
  EXPECT_EQ(FindCuts(Vector::Constant(10, 0.3)).size(), 1U);
}

TEST(Bursts, NumbersRunOnOverTheEndOfTheCycle) {
  const std::vector<double> cuts{0.2, 0.6};
  EXPECT_EQ(BurstOf(cuts, 0, 0.1) + 1, BurstOf(cuts, 0, 0.3));
  EXPECT_EQ(BurstOf(cuts, 0, 0.3) + 1, BurstOf(cuts, 0, 0.7));
  EXPECT_EQ(BurstOf(cuts, 0, 0.7), BurstOf(cuts, 1, 0.1)) << "one burst";
  EXPECT_EQ(BurstOf({}, 3, 0.5), 3);
}

TEST(SharedTiming, IsWhatMusclesHaveInCommon) {
  // Both early and late together by 0.03, each by 0.01 of its own, with and against.
  const std::vector<std::vector<BurstTiming>> together{
      {{0, 0, 0.04}, {0, 1, 0.02}, {1, 0, -0.04}, {1, 1, -0.02}},
      {{0, 0, 0.02}, {0, 1, 0.04}, {1, 0, -0.04}, {1, 1, -0.02}}};
  EXPECT_NEAR(SharedTiming(together), std::sqrt((0.0008 + 0.0008 + 0.0016 + 0.0004) / 4), 1e-12);
  EXPECT_EQ(SharedTiming({{{0, 0, 0.03}, {0, 1, -0.03}}, {{0, 0, -0.03}, {0, 1, 0.03}}}), 0) << "against";
  EXPECT_EQ(SharedTiming({{{0, 0, 0.03}}}), 0) << "one muscle";
}

}  // namespace
}  // namespace sinew
