#include "identify/statistics/alarm.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <cstdio>
#include <vector>

#include "base/random.h"
#include "identify/statistics/distributions.h"

namespace sinew::statistics {
namespace {

constexpr double kRounding = 1e-12;

/// Unit columns whose neighbours are correlated; the last `mates` repeat the first ones with the other sign.
Matrix SomeColumns(Random& random, int rows, int columns, int mates) {
  Matrix x(rows, columns + mates);
  for (int c = 0; c < columns; ++c) {
    for (int r = 0; r < rows; ++r) x(r, c) = random.Normal() + (c > 0 ? 0.8 * x(r, c - 1) : 0);
  }
  for (int c = 0; c < mates; ++c) x.col(columns + c) = -x.col(c);
  x.colwise().normalize();
  return x;
}

TEST(GroupPValue, IsTheChiSquaredTailOfTheRank) {
  Matrix r = Matrix::Identity(4, 4);
  r(0, 1) = r(1, 0) = 0.6;
  Vector t(4);
  t << 2, -1, 1.959963984540054, 0;
  EXPECT_NEAR(GroupPValue(r, t, {{2}, false, 1}), 0.05, kRounding);
  EXPECT_NEAR(GroupPValue(r, t, {{2}, true, 1}), 0.025, kRounding);
  EXPECT_EQ(GroupPValue(r, t, {{1}, true, 1}), 1);
  EXPECT_EQ(GroupPValue(r, t, {{3}, false, 1}), 1);
  EXPECT_EQ(GroupPValue(r, t, {{}, false, 1}), 1);
  // t' R^-1 t by hand: (t1^2 - 2 r t1 t2 + t2^2) / (1 - r^2); two degrees: exp(-x / 2).
  const double statistic = (4 + 2 * 0.6 * 2 + 1) / (1 - 0.36);
  EXPECT_NEAR(GroupPValue(r, t, {{0, 1}, false, 1}), std::exp(-statistic / 2), kRounding);
}

TEST(GroupPValue, EqualColumnsCountOnce) {
  Matrix r = Matrix::Identity(3, 3);
  r(0, 1) = r(1, 0) = -1;
  Vector t(3);
  t << 1.5, -1.5, 0;
  EXPECT_NEAR(GroupPValue(r, t, {{0, 1}, false, 1}), GroupPValue(r, t, {{0}, false, 1}), kRounding);
  const Matrix nothing = Matrix::Zero(3, 3);
  EXPECT_EQ(GroupPValue(nothing, t, {{0}, false, 1}), 1);
  EXPECT_EQ(GroupPValue(nothing, t, {{0}, true, 1}), 1);
}

TEST(AlarmLevel, OfIndependentTestsIsSidak) {
  constexpr int kTests = 40;
  std::vector<AlarmGroup> groups;
  for (int i = 0; i < kTests; ++i) groups.push_back({{i}, false, 1});
  constexpr int kDraws = 20000;
  const AlarmLevel alarm(Matrix::Identity(kTests, kTests), groups, 7, kDraws);
  const double sidak = 1 - std::pow(0.95, 1.0 / kTests);
  // Three binomial deviations of the share of draws below: 0.0046 of 0.05.
  const double deviation = std::sqrt(0.05 * 0.95 / kDraws);
  EXPECT_NEAR(alarm.FamilyPValue(sidak), 0.05, 3 * deviation);
  EXPECT_NEAR(alarm.Threshold(0.05) / sidak, 1, 3 * deviation / 0.05);
}

TEST(AlarmLevel, OfEqualGroupsIsThatOfOne) {
  const int n = 30;
  Matrix r(n, n);
  std::vector<AlarmGroup> groups;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) r(i, j) = (i + j) % 2 == 0 ? 1 : -1;
    groups.push_back({{i}, false, 1});
  }
  groups.push_back({{0, 1, 2}, false, 1});
  const AlarmLevel alarm(r, groups, 3, 20000);
  EXPECT_NEAR(alarm.Threshold(0.05), 0.05, 3 * std::sqrt(0.05 * 0.95 / 20000));
}

TEST(AlarmLevel, ThresholdAndFamilyPValueAgree) {
  Random random(11);
  const Matrix x = SomeColumns(random, 60, 20, 4);
  std::vector<AlarmGroup> groups;
  for (int i = 0; i < 24; ++i) groups.push_back({{i}, i % 3 == 0, i < 10 ? 1.0 : 5.0});
  groups.push_back({{0, 1, 2}, false, 1});
  const AlarmLevel alarm(x.transpose() * x, groups, 5);
  for (const double level : {1e-6, 1e-3, 0.01, 0.05, 0.3}) {
    const double threshold = alarm.Threshold(level);
    EXPECT_LE(alarm.FamilyPValue(threshold * (1 - 1e-12)), level * (1 + 1e-9)) << level;
    EXPECT_GE(alarm.FamilyPValue(threshold * (1 + 1e-9)), level * 0.99) << level;
  }
  EXPECT_EQ(alarm.FamilyPValue(1), 1);
  EXPECT_EQ(alarm.FamilyPValue(0), 0);
  // Far below any draw: Bonferroni.
  const double shares = 10 + 14 / 5.0 + 1;
  EXPECT_NEAR(alarm.FamilyPValue(1e-30), shares * 1e-30, 1e-42);
}

TEST(AlarmLevel, SameSeedSameAnswer) {
  const std::vector<AlarmGroup> groups = {{{0}, false, 1}, {{1, 2}, false, 1}};
  const Matrix r = Matrix::Identity(3, 3);
  EXPECT_EQ(AlarmLevel(r, groups, 9).FamilyPValue(0.3), AlarmLevel(r, groups, 9).FamilyPValue(0.3));
  EXPECT_NE(AlarmLevel(r, groups, 9).FamilyPValue(0.3), AlarmLevel(r, groups, 10).FamilyPValue(0.3));
}

TEST(AlarmLevel, NoGroupsRaiseNoAlarm) {
  const AlarmLevel alarm(Matrix(0, 0), {}, 1);
  EXPECT_EQ(alarm.FamilyPValue(1e-9), 1);
}

// The level holds for designs like those of a diagnosis: correlated columns, signs, groups, equal columns,
// weights; every case has its own design and its own draws.
TEST(AlarmLevel, FalseAlarmsHaveTheStatedRate) {
  constexpr int kCases = 1000;
  int alarms = 0;
  for (int i = 0; i < kCases; ++i) {
    Random random(static_cast<std::uint64_t>(100 + i));
    const Matrix x = SomeColumns(random, 40, 25, 5);
    std::vector<AlarmGroup> groups;
    for (int c = 0; c < 20; ++c) groups.push_back({{c}, c % 4 == 0, 1});
    for (int c = 20; c < 30; c += 2) groups.push_back({{c, c + 1, c - 20}, false, 5});
    const Matrix r = x.transpose() * x;
    const AlarmLevel alarm(r, groups, static_cast<std::uint64_t>(i), 1000);
    Vector noise(x.rows());
    for (double& value : noise) value = random.Normal();
    const Vector t = x.transpose() * noise;
    double smallest = 1;
    for (const AlarmGroup& group : groups) {
      smallest = std::min(smallest, group.weight * GroupPValue(r, t, group));
    }
    if (smallest < alarm.Threshold(0.05)) ++alarms;
  }
  // Three binomial deviations: 50 +- 21 (failing by chance: 0.3 %, decided by the fixed seeds).
  EXPECT_NEAR(alarms, 0.05 * kCases, 21);
  std::printf("false alarms: %d of %d at 5 %%\n", alarms, kCases);
}

}  // namespace
}  // namespace sinew::statistics
