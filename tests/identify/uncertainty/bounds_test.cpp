// Intervals where other values lie on a bound, and where a profile meets a better fit.
#include <gtest/gtest.h>

#include <cmath>

#include "identify/statistics/distributions.h"
#include "identify/uncertainty/profile.h"
#include "identify/uncertainty/uncertainty.h"
#include "tests/identify/support/toy_problem.h"
#include "tests/identify/uncertainty/curves.h"

namespace sinew {
namespace {

using toy::MakeBlock;
using toy::MakeParameter;
using toy::ToyFit;
using toy::ToyProblem;
using toy::Values;

// Of an end of a linear model: kRiseTolerance of profile_end.cpp is the share of the rise, half of it that of
// the end.
constexpr double kEnd = 1e-3;
constexpr double kSlope = 0.1;  // that the line has downward, beyond its bound

/// offset + slope t at t = 0, 1, 2 with slope >= 0, measured as (s, 0, -s): the best slope is 0, the offset
/// 0, and the cost falls beyond the bound.
ToyProblem LineOnItsBound() {
  ToyProblem problem({MakeParameter("offset", -10, 10, 1), MakeParameter("slope", 0, 10, 1)},
                     {MakeBlock("one", "height", 3, 2)}, Line);
  problem.Measure(Values({0, 0}), [](const Block&, int i) { return kSlope * (1 - i); });
  return problem;
}

/// Below the minimum the slope leaves its bound at 3 d = 2 s (sum of t: 3, of t r: 2 s), above never: rise =
/// 3 d^2 / 2
/// - max(0, 3 d - 2 s)^2 / (2 * 5), with 5 the sum of t^2.
double LowerDistance(double rise) {
  // 6 d^2 + 12 s d - (10 rise + 4 s^2) = 0
  const double b = 12 * kSlope;
  return (-b + std::sqrt(b * b + 24 * (10 * rise + 4 * kSlope * kSlope))) / 12;
}

TEST(Bounds, AProfileLetsAnotherValueLeaveItsBound) {
  const ToyProblem problem = LineOnItsBound();
  const ToyFit fit(problem);
  const Vector minimum = fit.view.Variables(Values({0, 0}));
  // Rise 1.5: the upper end is at 1, the lower one at 1.4864.
  EXPECT_NEAR(LowerDistance(1.5), 1.4864, 5e-5);
  const uncertainty::ProfileRequest request{0, 1.5, 1.0 / 20, Vector::Zero(2)};
  long evaluations = 0;
  const auto profiles =
      uncertainty::ProfileIntervals(fit.view, minimum, kSlope * kSlope, {request}, {}, evaluations);
  ASSERT_EQ(profiles.size(), 1U);
  EXPECT_EQ(profiles[0].lower.failure, ProfileFailure::kNone);
  EXPECT_NEAR(20 * profiles[0].upper.x - 10, 1, kEnd);
  EXPECT_NEAR(20 * profiles[0].lower.x - 10, -LowerDistance(1.5), 2 * kEnd);
  // The model of the minimum, and one or two points at each end.
  EXPECT_LE(evaluations, 5);
}

TEST(Bounds, ALinearIntervalDoesNotTakeAValueOnItsBoundAsKnown) {
  const ToyProblem problem = LineOnItsBound();
  const ToyFit fit(problem);
  UncertaintyOptions options;
  options.profile = false;
  const Result<Uncertainty> answer = AnalyseUncertainty(fit.view, fit.view.Start(), options);
  ASSERT_TRUE(answer);
  ASSERT_EQ(answer->minimum[1], 0);
  const ParameterVerdict& offset = answer->parameters[0];
  EXPECT_EQ(offset.interval, IntervalKind::kLinear);
  // Errors hold the slope: upward nothing changes.
  const double q = statistics::StudentTQuantile(0.975, answer->degrees_of_freedom);
  const double half = q * std::max(offset.std_error, offset.std_error_robust);
  const double rise = 0.5 * half * half * 3;  // (J'J)^-1 = 1/3
  EXPECT_NEAR(offset.ci95_upper, answer->minimum[0] + half, kEnd * half);
  EXPECT_NEAR(offset.ci95_lower, answer->minimum[0] - LowerDistance(rise), 2 * kEnd * half);
}

// Two residuals, (a^2 - 1) / 2 and (a + 1) / 4, with known noise 0.8: the global minimum is a = -1 with cost
// 0; another one, of cost 0.117, lies at a = 0.86, behind a barrier of 0.16, far lower than a 95 % interval
// allows. The slope there is 0.89: the first model's end is 1.96 * 0.8 / 0.89 below, in the other well.
Result<double> DoubleWell(const Block& /*block*/, double t, const Vector& p, Vector* gradient) {
  const bool first = t < 0.5;
  if (gradient != nullptr) *gradient << (first ? p[0] : 0.25);
  return first ? 0.5 * (p[0] * p[0] - 1) : 0.25 * (p[0] + 1);
}

TEST(Bounds, ABetterFitOnTheWayIsHandedOver) {
  Layout layout = {MakeBlock("one", "wells", 2, 1)};
  layout[0].sigma = 0.8;
  const ToyProblem known({MakeParameter("a", -3, 3, 0.9)}, layout, DoubleWell);
  const ToyFit fit(known);
  const Result<Uncertainty> answer = AnalyseUncertainty(fit.view, fit.view.Start(), {});
  ASSERT_TRUE(answer);
  EXPECT_NEAR(answer->minimum[0], 0.86, 0.01);
  ASSERT_EQ(answer->better_point.size(), 1);
  EXPECT_LT(fit.view.Parameters(answer->better_point)[0], 0);
  ASSERT_FALSE(answer->notes.empty());
  EXPECT_EQ(answer->notes.back().kind, WarningKind::kBetterFit);
  EXPECT_LT(answer->notes.back().numbers[1], answer->notes.back().numbers[0]);
}

}  // namespace
}  // namespace sinew
