#include "identify/uncertainty/profile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "base/random.h"
#include "identify/statistics/distributions.h"
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

// kEndTolerance and kRefitTolerance of the profile, and the step of the grid that it is compared with.
constexpr double kProfileEnd = 5e-3;

/// Measured for less than one time constant.
ToyProblem DecayProblem(double sigma) {
  ToyProblem problem({MakeParameter("amplitude", 0, 50, 3), MakeParameter("rate", 0, 20, 1)},
                     {MakeBlock("one", "height", 25, 2)}, Decay);
  Random random(11);
  problem.Measure(Values({3, 1.2}), [&](const Block&, int) { return sigma * random.Normal(); });
  return problem;
}

/// Cost at a rate with the best amplitude, in closed form.
double CostAtRate(const Block& block, double rate) {
  double ss = 0;
  double sy = 0;
  double yy = 0;
  for (std::size_t i = 0; i < block.measured.size(); ++i) {
    const double shape = std::exp(-rate * block.prediction_time[i]);
    ss += shape * shape;
    sy += shape * block.measured[i];
    yy += block.measured[i] * block.measured[i];
  }
  return 0.5 * (yy - sy * sy / ss);
}

TEST(Profile, OfADecayMatchesABruteForceGridAndIsAsymmetric) {
  const ToyProblem problem = DecayProblem(0.8);
  const ToyFit fit(problem);
  const Result<Uncertainty> answer = AnalyseUncertainty(fit.view, fit.view.Start(), {});
  ASSERT_TRUE(answer);
  const ParameterVerdict& rate = answer->parameters[1];
  ASSERT_EQ(rate.interval, IntervalKind::kProfile) << ToString(rate.reason.no_profile);

  const Block& block = problem.layout()[0];
  const double best = answer->minimum[1];
  const double q = statistics::StudentTQuantile(0.975, 23);
  const double widening = std::max(1.0, std::pow(rate.std_error_robust / rate.std_error, 2));
  const double variance = 2 * CostAtRate(block, best) / 23;
  const double limit = CostAtRate(block, best) + 0.5 * q * q * variance * widening;
  const double step = 1e-4 * best;
  double lower = best;
  while (CostAtRate(block, lower) < limit) lower -= step;
  double upper = best;
  while (CostAtRate(block, upper) < limit) upper += step;

  EXPECT_NEAR(rate.ci95_lower, lower, kProfileEnd * (best - lower));
  EXPECT_NEAR(rate.ci95_upper, upper, kProfileEnd * (upper - best));
  EXPECT_GT(rate.ci95_upper - best, 1.2 * (best - rate.ci95_lower));  // a fast decay is harder to rule out
}

TEST(Profile, IsTheSameForAnyNumberOfThreads) {
  const ToyProblem problem = DecayProblem(0.3);
  const ToyFit fit(problem);
  UncertaintyOptions options;
  const Result<Uncertainty> one = AnalyseUncertainty(fit.view, fit.view.Start(), options);
  options.threads = 4;
  const Result<Uncertainty> four = AnalyseUncertainty(fit.view, fit.view.Start(), options);
  ASSERT_TRUE(one && four);
  EXPECT_EQ(one->evaluations, four->evaluations);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(one->parameters[i].ci95_lower, four->parameters[i].ci95_lower);
    EXPECT_EQ(one->parameters[i].ci95_upper, four->parameters[i].ci95_upper);
  }
}

TEST(Profile, NeedsFewEvaluations) {
  const ToyProblem problem = DecayProblem(0.3);
  const ToyFit fit(problem);
  const Result<Uncertainty> answer = AnalyseUncertainty(fit.view, fit.view.Start(), {});
  ASSERT_TRUE(answer);
  // Four ends of about five points with two or three evaluations each, and the first search.
  EXPECT_LT(answer->evaluations, 80);
}

TEST(Profile, FallsBackToTheLinearIntervalWhenTheBudgetIsGone) {
  const ToyProblem problem = DecayProblem(0.3);
  const ToyFit fit(problem);
  UncertaintyOptions options;
  options.max_profile_evaluations = 1;
  const Result<Uncertainty> answer = AnalyseUncertainty(fit.view, fit.view.Start(), options);
  ASSERT_TRUE(answer);
  const ParameterVerdict& rate = answer->parameters[1];
  EXPECT_EQ(rate.interval, IntervalKind::kLinear);
  EXPECT_EQ(rate.reason.no_profile, ProfileFailure::kBudgetSpent);
  const double half =
      statistics::StudentTQuantile(0.975, 23) * std::max(rate.std_error, rate.std_error_robust);
  EXPECT_NEAR(rate.ci95_upper - answer->minimum[1], half, 1e-9);  // rounding

  const std::atomic<bool> stop{true};
  options = {};
  options.interrupt = &stop;
  const Result<Uncertainty> stopped = AnalyseUncertainty(fit.view, fit.view.Start(), options);
  ASSERT_TRUE(stopped);
  EXPECT_EQ(stopped->parameters[1].reason.no_profile, ProfileFailure::kInterrupted);
}

TEST(Profile, EndsOpenAtABound) {
  ToyProblem problem({MakeParameter("amplitude", 0, 50, 3), MakeParameter("rate", 0, 1.4, 1)},
                     {MakeBlock("one", "height", 25, 2)}, Decay);
  Random random(11);
  problem.Measure(Values({3, 1.2}), [&](const Block&, int) { return 0.4 * random.Normal(); });
  const ToyFit fit(problem);
  const Result<Uncertainty> answer = AnalyseUncertainty(fit.view, fit.view.Start(), {});
  ASSERT_TRUE(answer);
  const ParameterVerdict& rate = answer->parameters[1];
  EXPECT_TRUE(rate.upper_open);
  EXPECT_EQ(rate.ci95_upper, 1.4);
  EXPECT_FALSE(rate.lower_open);
}

TEST(Profile, SurvivesClampedContact) {
  // Unilateral springs: force = sum over faces of k max(0, depth + shift), with kinks all over the range.
  ToyProblem problem({MakeParameter("stiffness", 10, 1000, 200), MakeParameter("shift", -0.5, 0.5, 0.1)},
                     {MakeBlock("one", "force", 60, 1)},
                     [](const Block&, double t, const Vector& p, Vector* gradient) -> Result<double> {
                       double sum = 0;
                       int touching = 0;
                       for (int face = 0; face < 8; ++face) {
                         const double depth = std::sin(3 * t) - 0.15 * face + p[1];
                         if (depth <= 0) continue;
                         sum += depth;
                         ++touching;
                       }
                       if (gradient != nullptr) *gradient << sum, p[0] * touching;
                       return p[0] * sum;
                     });
  Random random(2);
  problem.Measure(Values({300, 0.05}), [&](const Block&, int) { return 40 * random.Normal(); });
  const ToyFit fit(problem);
  const Result<Uncertainty> answer = AnalyseUncertainty(fit.view, fit.view.Start(), {});
  ASSERT_TRUE(answer);
  for (const ParameterVerdict& verdict : answer->parameters) {
    EXPECT_EQ(verdict.interval, IntervalKind::kProfile) << ToString(verdict.reason.no_profile);
    const double half = 2 * std::max(verdict.std_error, verdict.std_error_robust);
    EXPECT_NEAR(verdict.ci95_upper - verdict.ci95_lower, 2 * half, half);  // kinks bend it, but not by half
  }
}

// The simulation fails above a rate that is inside the interval, but beyond the linear one: what was reached
// is in the interval.
TEST(Profile, RegionWithoutPredictionIsNoEnd) {
  const auto rate_of = [](double most, bool profile) {
    ToyProblem problem(
        {MakeParameter("amplitude", 0, 50, 3), MakeParameter("rate", 0, 20, 1)},
        {MakeBlock("one", "height", 25, 2)},
        [most](const Block& block, double t, const Vector& p, Vector* gradient) -> Result<double> {
          if (p[1] > most) return Fail("step under the minimum at t = {}", t);
          return Decay(block, t, p, gradient);
        });
    Random random(11);
    problem.Measure(Values({3, 1.2}), [&](const Block&, int) { return 1.6 * random.Normal(); });
    const ToyFit fit(problem);
    UncertaintyOptions options;
    options.profile = profile;
    return AnalyseUncertainty(fit.view, fit.view.Start(), options)->parameters[1];
  };
  const ParameterVerdict linear = rate_of(100, false);
  const ParameterVerdict whole = rate_of(100, true);
  ASSERT_LT(1.05 * linear.ci95_upper, whole.ci95_upper);
  const double most = 0.5 * (linear.ci95_upper + whole.ci95_upper);
  const ParameterVerdict found = rate_of(most, true);
  EXPECT_EQ(found.interval, IntervalKind::kLinear);
  EXPECT_EQ(found.reason.no_profile, ProfileFailure::kNoPrediction);
  EXPECT_NEAR(found.ci95_upper, most, 0.01 * most);
  EXPECT_NEAR(found.ci95_lower, std::min(linear.ci95_lower, whole.ci95_lower), 1e-9);
}

// The best value of the other variable is at the edge of a jump of the cost, to which its slope leads: models
// of points beyond the edge say nothing of the way to the end.
TEST(Profile, OfAMinimumAtAJumpIsNotNarrow) {
  constexpr double kRise = 0.5;  // at a distance of 1 if the other one stays at 0
  const ToyProblem problem({MakeParameter("value", -5, 5, 0), MakeParameter("other", -5, 5, 0)},
                           {MakeBlock("one", "y", 3, 2)},
                           [](const Block&, double t, const Vector& p, Vector* gradient) -> Result<double> {
                             if (gradient != nullptr)
                               *gradient = Values({t == 0 ? 1.0 : 0.0, t == 1 ? 1.0 : 0.0});
                             if (t == 0) return p[0];
                             if (t == 1) return p[1] - 0.5;
                             return p[1] > 0 ? 1.19 : 0.0;
                           });
  const ToyFit fit(problem);
  const Vector minimum = fit.view.Variables(Values({0, 0}));
  auto workspace = fit.view.NewWorkspace();
  const Result<double> cost = fit.view.Cost(minimum, workspace);
  ASSERT_TRUE(cost);
  long evaluations = 0;
  const auto profiles = uncertainty::ProfileIntervals(fit.view, minimum, *cost,
                                                      {{0, kRise, 0.1, Vector::Unit(2, 0)}}, {}, evaluations);
  for (const auto& end : {profiles[0].lower, profiles[0].upper}) {
    if (end.failure == ProfileFailure::kNone) {
      EXPECT_NEAR(std::abs(end.x - minimum[0]), 0.1, 0.002);
    }
  }
}

}  // namespace
}  // namespace sinew
