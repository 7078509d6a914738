// Classification of curves whose shares of explained variance are worked out by hand.
#include "identify/diagnosis/discover/shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "base/constants.h"
#include "base/random.h"

namespace sinew::diagnosis {
namespace {

// Shares are ratios of sums of at most 41 numbers of order 1 to 1000: rounding stays far below this.
constexpr double kRounding = 1e-12;

std::vector<double> Even(double low, double high, int count) {
  std::vector<double> knots;
  for (int i = 0; i < count; ++i) knots.push_back(low + (high - low) * i / (count - 1));
  return knots;
}

std::vector<double> ValuesAt(const std::vector<double>& knots, const std::function<double(double)>& law) {
  std::vector<double> values;
  for (const double x : knots) values.push_back(law(x));
  return values;
}

double Sign(double x) {
  return x > 0 ? 1 : x < 0 ? -1 : 0;
}

struct ExactLaw {
  ShapeKind kind;
  std::function<double(double)> law;
};

TEST(Shape, ExactLawsExplainEverything) {
  const std::vector<double> knots = Even(-3, 3, 7);
  const std::vector<ExactLaw> laws = {{ShapeKind::kLinear, [](double x) { return x; }},
                                      {ShapeKind::kQuadraticOdd, [](double x) { return x * std::abs(x); }},
                                      {ShapeKind::kCubic, [](double x) { return x * x * x; }},
                                      {ShapeKind::kQuadraticEven, [](double x) { return x * x; }},
                                      {ShapeKind::kStep, Sign}};
  for (const ExactLaw& exact : laws) {
    // Neither the size, nor the sign, nor a constant changes the answer.
    for (const double size : {1.0, -0.02}) {
      const Shape shape =
          FindShape(knots, ValuesAt(knots, [&](double x) { return 5 + size * exact.law(x); }), {});
      EXPECT_EQ(shape.kind, exact.kind) << ToString(shape.kind);
      // The constant 5 beside a curve of size 0.02 costs five digits of rounding.
      EXPECT_NEAR(shape.explained, 1, 1e-10) << ToString(exact.kind);
      EXPECT_TRUE(shape.simple());
    }
  }
}

// tanh(x / 0.25 c) at 41 knots: a step explains (sum |y|)^2 / (40 sum y^2) = 0.9342, more than 0.05 less.
TEST(Shape, SaturationIsNamedWhereAStepExplainsClearlyLess) {
  const std::vector<double> knots = Even(-2, 2, 41);
  const Shape shape = FindShape(knots, ValuesAt(knots, [](double x) { return std::tanh(x / 0.5); }), {});
  EXPECT_EQ(shape.kind, ShapeKind::kSaturating);
  EXPECT_NEAR(shape.explained, 1, kRounding);
}

// tanh(x / 0.1 c) at 21 knots: by the same sum a step explains 0.994703 (numpy), and it has no width to
// choose.
TEST(Shape, StepIsPreferredToASaturationThatExplainsLittleMore) {
  const std::vector<double> knots = Even(-1, 1, 21);
  const Shape shape = FindShape(knots, ValuesAt(knots, [](double x) { return std::tanh(x / 0.1); }), {});
  EXPECT_EQ(shape.kind, ShapeKind::kStep);
  EXPECT_NEAR(shape.explained, 0.994703, 1e-6) << "the digits stated";
}

TEST(Shape, PeakAroundZeroIsNamed) {
  const std::vector<double> knots = Even(-1, 1, 21);
  for (const double width : {0.1, 0.25}) {
    const Shape shape = FindShape(
        knots, ValuesAt(knots, [&](double x) { return Sign(x) * std::exp(-std::pow(x / width, 2)); }), {});
    EXPECT_EQ(shape.kind, ShapeKind::kPeak) << width;
    EXPECT_NEAR(shape.explained, 1, kRounding) << width;
  }
}

// A sine of three periods over the knots 5 to 17, whatever its phase.
TEST(Shape, SineIsNamedWithItsPeriod) {
  const std::vector<double> knots = Even(5, 17, 13);
  for (const double phase : {0.0, 1.0, 2.0}) {
    const Shape shape =
        FindShape(knots, ValuesAt(knots, [&](double x) { return std::sin(kPi * x / 2 + phase); }), {});
    EXPECT_EQ(shape.kind, ShapeKind::kPeriodic) << phase;
    EXPECT_NEAR(shape.period, 4, kRounding);
    EXPECT_NEAR(shape.explained, 1, kRounding);
  }
}

TEST(Shape, OnlyAPeriodicShapeHasAPeriod) {
  const std::vector<double> knots = Even(-3, 3, 13);
  EXPECT_EQ(FindShape(knots, knots, {}).period, 0);
}

// x = -3, -1, 1, 3 and y = -2, -4, 4, 2. A step: (2 + 4 + 4 + 2)^2 / (4 * 40) = 0.9. A line: (6 + 4 + 4 +
// 6)^2 / (20 * 40) = 0.5.
TEST(Shape, ExplainedShareMatchesAHandCalculation) {
  const Shape shape = FindShape({-3, -1, 1, 3}, {-2, -4, 4, 2}, {});
  EXPECT_EQ(shape.kind, ShapeKind::kStep);
  EXPECT_NEAR(shape.explained, 0.9, kRounding);
  EXPECT_TRUE(shape.simple());
}

// y = x + (1, -1, -1, 1), which is orthogonal to 1 and x: the line explains 20 / 24, less than the 0.85 that
// a name needs.
TEST(Shape, LawThatExplainsTooLittleIsNotSimple) {
  const Shape shape = FindShape({-3, -1, 1, 3}, {-2, -2, 0, 4}, {});
  EXPECT_EQ(shape.kind, ShapeKind::kLinear);
  EXPECT_NEAR(shape.explained, 5.0 / 6, kRounding);
  EXPECT_FALSE(shape.simple());
}

// Fourth differences are orthogonal to all polynomials below the fourth degree and, being even, to a step.
TEST(Shape, CurveOrthogonalToAllLawsIsNotExplained) {
  const Shape shape = FindShape({-2, -1, 0, 1, 2}, {1, -4, 6, -4, 1}, {});
  EXPECT_NEAR(shape.explained, 0, kRounding);
  EXPECT_FALSE(shape.simple());
}

// Weights 1, 3, 3, 1 for the curve above. A step: (2 + 12 + 12 + 2)^2 / (8 * (4 + 48 + 48 + 4)) = 49 / 52.
TEST(Shape, WeightsCountAsRepetitions) {
  const Shape shape = FindShape({-3, -1, 1, 3}, {-2, -4, 4, 2}, {1, 3, 3, 1});
  EXPECT_EQ(shape.kind, ShapeKind::kStep);
  EXPECT_NEAR(shape.explained, 49.0 / 52, kRounding);
}

TEST(Shape, ValueOfWeightZeroIsIgnored) {
  const Shape shape = FindShape(Even(-3, 3, 7), {-3, -2, -1, 0, 1, 50, 3}, {1, 1, 1, 1, 1, 0, 1});
  EXPECT_EQ(shape.kind, ShapeKind::kLinear);
  EXPECT_NEAR(shape.explained, 1, kRounding);
}

// sign x at 0, 1, 2, 3 has no side below zero: about the means, a line explains 1.5^2 / (5 * 0.75) = 0.6, a
// square 3.5^2 / (49 * 0.75) = 1 / 3.
TEST(Shape, CurveOnOneSideOfZeroIsNoStep) {
  const Shape shape = FindShape({0, 1, 2, 3}, {0, 1, 1, 1}, {});
  EXPECT_EQ(shape.kind, ShapeKind::kLinear);
  EXPECT_NEAR(shape.explained, 0.6, kRounding);
}

TEST(Shape, IsNoneForFewerThanFourValuesOrWithoutWeight) {
  EXPECT_EQ(FindShape({-1, 0, 1}, {-1, 0, 1}, {}).kind, ShapeKind::kNone);
  EXPECT_FALSE(FindShape({-1, 0, 1}, {-1, 0, 1}, {}).simple());
  EXPECT_EQ(FindShape({-1, 0, 1, 2}, {-1, 0, 1, 2}, {0, 0, 0, 0}).kind, ShapeKind::kNone);
}

TEST(Shape, FlatZeroCurveIsNotSimple) {
  EXPECT_FALSE(FindShape(Even(-3, 3, 7), std::vector<double>(7, 0), {}).simple());
}

// The mean of such values differs from them by rounding, which has no shape.
TEST(Shape, ConstantCurveHasNone) {
  for (const double value : {0.0, 0.1, -1.0 / 3, 3.3e7, 1e-9}) {
    for (const int n : {5, 7, 8, 24}) {
      std::vector<double> weight(static_cast<std::size_t>(n));
      for (int i = 0; i < n; ++i) weight[static_cast<std::size_t>(i)] = 1 + 0.37 * i;
      const std::vector<double> curve(static_cast<std::size_t>(n), value);
      EXPECT_EQ(FindShape(Even(-3, 3, n), curve, weight).kind, ShapeKind::kNone) << value << " " << n;
      EXPECT_EQ(FindShape(Even(-3, 3, n), curve, {}).kind, ShapeKind::kNone) << value << " " << n;
    }
  }
}

// Far from zero, but no constant.
TEST(Shape, SmallChangesOfALargeValueHaveAShape) {
  const Shape shape =
      FindShape(Even(-3, 3, 7), {1e6 - 3, 1e6 - 2, 1e6 - 1, 1e6, 1e6 + 1, 1e6 + 2, 1e6 + 3}, {});
  EXPECT_EQ(shape.kind, ShapeKind::kLinear);
  EXPECT_TRUE(shape.simple());
}

// The best of all laws explained on average 0.22, and at most 0.65, of 4000 such curves in a script with
// numpy: 0.85 is not reached by chance.
TEST(Shape, NoiseIsNotSimple) {
  const std::vector<double> knots = Even(-1, 1, 24);
  Random random(1);
  double mean = 0;
  for (int i = 0; i < 200; ++i) {
    const Shape shape = FindShape(knots, ValuesAt(knots, [&](double) { return random.Normal(); }), {});
    EXPECT_FALSE(shape.simple()) << i << ": " << ToString(shape.kind) << " " << shape.explained;
    mean += shape.explained / 200;
  }
  // The deviation of one share is below 0.12, that of the mean of 200 below 0.009; more than five of them.
  EXPECT_NEAR(mean, 0.223, 0.05);
}

}  // namespace
}  // namespace sinew::diagnosis
