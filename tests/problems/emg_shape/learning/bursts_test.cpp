#include "problems/emg_shape/learning/bursts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

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
  const auto one = FindBursts(Curve({{0.5, 0.3}}));
  ASSERT_EQ(one.cuts.size(), 1U);
  EXPECT_NEAR(one.cuts[0].phase, 0.8, 0.02);
  const auto two = FindBursts(Curve({{0.5, 0.2}, {0.1, 0.7}}));
  ASSERT_EQ(two.cuts.size(), 2U);
  EXPECT_LT(two.cuts[0].phase, 0.02 + 0.5);
  EXPECT_GT(two.cuts[0].phase, 0.38);
  EXPECT_GT(two.cuts[1].phase, 0.9);
  // A bump of 1 % is none; over the cycle's end a burst is one.
  EXPECT_EQ(FindBursts(Curve({{0.5, 0.2}, {0.005, 0.7}})).count(), 1);
  EXPECT_EQ(FindBursts(Curve({{0.5, 0.99}, {0.3, 0.5}})).count(), 2);
  EXPECT_EQ(FindBursts(Vector::Constant(10, 0.3)).count(), 1);
}

TEST(Bursts, NumbersRunOnOverTheEndOfTheCycle) {
  const BurstPattern two{{{0.2, 50, 0.1}, {0.6, 50, 0.1}}, 1, 0};
  EXPECT_EQ(two.BurstAt(0, 0.1) + 1, two.BurstAt(0, 0.3));
  EXPECT_EQ(two.BurstAt(0, 0.3) + 1, two.BurstAt(0, 0.7));
  EXPECT_EQ(two.BurstAt(0, 0.7), two.BurstAt(1, 0.1)) << "one burst";
  EXPECT_EQ(BurstPattern{}.BurstAt(3, 0.5), 3);
}

TEST(Bursts, OthersBelongToTheMainOneBeforeOrAfterThem) {
  const Vector curve = Curve({{0.5, 0.3}, {0.2, 0.8}});
  BurstPattern pattern = FindBursts(curve);
  const auto cycle = [&](int k, double phase) { return pattern.CycleOf(pattern.BurstAt(k, phase)); };
  for (const int k : {-2, -1, 0, 5}) {
    pattern.after = 1;
    EXPECT_EQ(cycle(k, 0.3), k);
    EXPECT_EQ(cycle(k, 0.8), k) << "with the one before";
    pattern.after = 0;
    EXPECT_EQ(cycle(k, 0.3), k);
    EXPECT_EQ(cycle(k, 0.8), k + 1) << "with the next one";
  }
  pattern = FindBursts(Curve({{0.5, 0.3}}));
  pattern.after = 3;
  EXPECT_EQ(cycle(-4, 0.3), -4);
  EXPECT_EQ(cycle(4, 0.3), 4);
}

TEST(Bursts, SharesAreThoseOfBellCurves) {
  // Two bell curves of width 0.07 without a floor.
  Vector curve = Curve({{0.5, 0.25}, {0.3, 0.7}});
  curve.array() -= 0.02;
  const BurstPattern pattern = FindBursts(curve);
  ASSERT_EQ(pattern.count(), 2);
  const BurstCut& cut = pattern.cuts[0];
  for (double phase = cut.phase - 0.08; phase < cut.phase + 0.08; phase += 0.01) {
    const double first = 0.5 * std::exp(-0.5 * std::pow((phase - 0.25) / 0.07, 2));
    const double second = 0.3 * std::exp(-0.5 * std::pow((phase - 0.7) / 0.07, 2));
    // The lowest point is not quite where both are equal.
    EXPECT_NEAR(cut.Later(phase - cut.phase).value, second / (first + second), 0.2) << phase;
    const double step = 1e-6;
    EXPECT_NEAR(
        cut.Later(phase - cut.phase).slope,
        (cut.Later(phase - cut.phase + step).value - cut.Later(phase - cut.phase - step).value) / (2 * step),
        1e-4);
  }
  EXPECT_EQ(cut.Later(-0.3).value, 0);
  EXPECT_EQ(cut.Later(0.3).value, 1);
}

}  // namespace
}  // namespace sinew
