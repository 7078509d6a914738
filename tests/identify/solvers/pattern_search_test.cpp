#include "identify/solvers/pattern_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <utility>

namespace sinew::solvers {
namespace {

Vector Pair(double a, double b) {
  Vector pair(2);
  pair << a, b;
  return pair;
}

// Falls towards (3, 0.2), along a valley in the logarithms.
double Valley(const Vector& values) {
  const double a = std::log(values[0] / 3);
  const double b = std::log(values[1] / 0.2);
  return a * a + b * b + a * b;
}

struct Searched {
  std::set<std::pair<double, double>> tried;
  int trials = 0;
  double lowest = std::numeric_limits<double>::infinity();
  Vector end;
  Searched(const Vector& lower, const Vector& upper, const Vector& from, int stop_after = 100000) {
    lowest = Valley(from);
    PatternSearch search(
        lower, upper, Pair(2, 10),
        [&](const Vector& values) {
          ++trials;
          tried.emplace(values[0], values[1]);
          if (!(Valley(values) < lowest)) return false;
          lowest = Valley(values);
          return true;
        },
        [&, stop_after] { return trials >= stop_after; });
    end = search.From(from);
  }
};

TEST(PatternSearch, EndsWithinTheLastStepOfTheMinimum) {
  const Searched found(Pair(1e-6, 1e-6), Pair(1e6, 1e6), Pair(100, 100));
  EXPECT_NEAR(std::log(found.end[0] / 3), 0, std::log(2) / 4);
  EXPECT_NEAR(std::log(found.end[1] / 0.2), 0, std::log(10) / 4);
  EXPECT_EQ(found.lowest, Valley(found.end));
}

TEST(PatternSearch, TriesNothingTwice) {
  const Searched found(Pair(1e-6, 1e-6), Pair(1e6, 1e6), Pair(100, 100));
  EXPECT_EQ(found.tried.size(), static_cast<std::size_t>(found.trials));
  EXPECT_LT(found.trials, 60);
}

TEST(PatternSearch, StaysWithinTheBounds) {
  const Searched found(Pair(5, 1e-3), Pair(80, 1), Pair(80, 1));
  for (const auto& [a, b] : found.tried) {
    EXPECT_GE(a, 5);
    EXPECT_LE(a, 80);
    EXPECT_GE(b, 1e-3);
    EXPECT_LE(b, 1);
  }
  EXPECT_DOUBLE_EQ(found.end[0], 5);
}

TEST(PatternSearch, GoesNowhereFromTheMinimumAndStopsWhenTold) {
  EXPECT_EQ(Searched(Pair(1e-6, 1e-6), Pair(1e6, 1e6), Pair(3, 0.2)).end, Pair(3, 0.2));
  EXPECT_EQ(Searched(Pair(1e-6, 1e-6), Pair(1e6, 1e6), Pair(100, 100), 1).trials, 1);
}

}  // namespace
}  // namespace sinew::solvers
