#include "identify/solvers/probed_start.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "identify/solvers/improved_start.h"
#include "identify/solvers/local_fit.h"
#include "tests/identify/support/function_problem.h"
#include "tests/identify/support/rippled_problem.h"

namespace sinew {
namespace {

using rippled::kCostOfNoise;
using rippled::kPeriod;
using rippled::kRipplePeriod;
using rippled::kStep;
using rippled::Rippled;

FitRequest Release(const std::vector<std::string>& effects) {
  FitRequest request;
  request.release = effects;
  return request;
}

Vector Probed(const Fit& fit, bool stopped = false) {
  return solvers::ProbedStart(fit.least_squares, fit.least_squares.Start(), {[=] { return stopped; }, {}});
}

double EndOfLocalFit(const Fit& fit, const Vector& start) {
  return solvers::LocalFit(fit.least_squares).Minimize(start, -1, {0, 1e-9}, 500).cost;
}

TEST(ProbedStart, FindsThePeriodOfARippleThatALocalSearchMisses) {
  const Rippled problem;
  const Fit fit(problem, Release({"ripple"}));
  EXPECT_GT(EndOfLocalFit(fit, fit.least_squares.Start()), 1) << "the start alone should miss it";
  const Vector start = Probed(fit);
  EXPECT_NEAR(fit.least_squares.Parameters(start)[kRipplePeriod], kPeriod, 1e-4);
  EXPECT_LT(EndOfLocalFit(fit, start), 1.3 * kCostOfNoise);
}

TEST(ProbedStart, OfSeveralEffectsTheOneThatExplainsMoreComesFirst) {
  const Rippled problem;
  const Fit fit(problem, Release({"step", "ripple"}));
  const Vector start = fit.least_squares.Parameters(Probed(fit));
  EXPECT_NEAR(start[kRipplePeriod], kPeriod, 1e-4);
  EXPECT_NEAR(std::pow(start[kStep], 3), 0, 1e-3);
}

TEST(ProbedStart, AStatedStartIsKept) {
  const Rippled problem;
  FitRequest request = Release({"ripple"});
  // 0.25 and 1 are a probe value and the null.
  for (const double stated : {0.3, 0.25, 1.0}) {
    request.start = {{"ripple_period", stated}};
    const Fit fit(problem, request);
    EXPECT_EQ(Probed(fit), fit.least_squares.Start()) << stated;
  }
}

TEST(ProbedStart, WithoutSuchEffectsOrWhenStoppedItIsTheStart) {
  const Rippled problem;
  const Fit base(problem);
  EXPECT_EQ(Probed(base), base.least_squares.Start());
  const Fit fit(problem, Release({"ripple"}));
  EXPECT_EQ(Probed(fit, true), fit.least_squares.Start());
}

TEST(ProbedStart, ProbeValuesOutsideTheFitsBoundsAreLeftOut) {
  const Rippled problem;
  FitRequest request = Release({"ripple"});
  request.bounds = {{"ripple_period", {0.2, 1}}};
  const Fit fit(problem, request);
  EXPECT_GE(fit.least_squares.Parameters(Probed(fit))[kRipplePeriod], 0.2);
}

TEST(ProbedStart, TheEvaluatorRecordsTheGivenStartAndPointsOnTheWay) {
  const Rippled problem;
  const Fit fit(problem, Release({"ripple"}));
  Evaluator evaluator(fit.least_squares, {});
  const Vector start = solvers::BestStart(evaluator);
  EXPECT_EQ(start, Probed(fit));
  ASSERT_EQ(evaluator.evaluations(), 2) << "an answer where a limit of time ends the search";
  EXPECT_EQ(evaluator.trace().front().x, fit.least_squares.Start());
  EXPECT_LT(evaluator.best().cost, evaluator.trace().front().cost);
  const Fit base(problem);
  Evaluator of_base(base.least_squares, {});
  EXPECT_EQ(solvers::BestStart(of_base), base.least_squares.Start());
  EXPECT_EQ(of_base.evaluations(), 0);
}

}  // namespace
}  // namespace sinew
