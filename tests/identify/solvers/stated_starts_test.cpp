#include "identify/solvers/stated_starts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "base/constants.h"
#include "identify/solvers/solver.h"
#include "tests/identify/support/function_problem.h"

namespace sinew {
namespace {

constexpr double kLag = 0.3;
constexpr double kFactor = 1.5;

// Two sines late by a lag, whose cost has several minima along the lag.
void MakeLag(FunctionProblem& problem, const std::vector<double>& other_starts) {
  Parameter lag = BaseParameter("lag", "s", "of the sines", -1.2, 0.7, -0.9);
  lag.other_starts = other_starts;
  problem.Add(lag).Add("factor", 0.1, 3, 1);
  const auto sines = [](double t) { return std::sin(2 * kPi * t) + 0.3 * std::sin(kPi * t); };
  std::vector<double> measured;
  for (int i = 0; i < 40; ++i) measured.push_back(kFactor * sines(0.05 * i - kLag));
  problem.AddBlock("trial", measured, {0, 1},
                   [=](const Vector& p, Eigen::Ref<Vector> values, Matrix* derivatives) -> Status {
                     for (int i = 0; i < 40; ++i) {
                       const double t = 0.05 * i - p[0];
                       values[i] = p[1] * sines(t);
                       if (derivatives == nullptr) continue;
                       (*derivatives)(i, 0) =
                           -p[1] * (2 * kPi * std::cos(2 * kPi * t) + 0.3 * kPi * std::cos(kPi * t));
                       (*derivatives)(i, 1) = sines(t);
                     }
                     return {};
                   });
}

SolverResult Solve(const Fit& fit, Evaluator& evaluator, int threads = 1) {
  SolverOptions options;
  options.threads = threads;
  return MakeSolver("starts", options).value()->Solve(evaluator, fit.least_squares.Start());
}

TEST(StatedStarts, FindsTheMinimumThatTheGivenStartMisses) {
  FunctionProblem alone;
  MakeLag(alone, {});
  const Fit missed(alone);
  Evaluator single(missed.least_squares, {});
  const SolverResult first = Solve(missed, single);
  EXPECT_GT(first.cost, 0.1) << "the given start alone should end in another minimum";
  EXPECT_TRUE(first.stages.empty()) << "without other starts it is lm";

  FunctionProblem problem;
  MakeLag(problem, {-0.1, 0.2, 0.7});
  const Fit fit(problem);
  Evaluator evaluator(fit.least_squares, {});
  const SolverResult result = Solve(fit, evaluator);
  const Vector found = fit.least_squares.Parameters(result.x);
  EXPECT_NEAR(found[0], kLag, 1e-6);
  EXPECT_NEAR(found[1], kFactor, 1e-6);
  EXPECT_EQ(result.stop.kind, Termination::kStartsDone);
  ASSERT_EQ(result.stages.size(), 4u);
  EXPECT_LE(result.stages.front().cost, result.stages.back().cost);
  EXPECT_NE(result.stop.test.find("of 4 stated starts of local searches end at the lowest cost"),
            std::string::npos)
      << result.stop.test;
}

TEST(StatedStarts, LeavesOutWhatTheFitsBoundsExclude) {
  FunctionProblem problem;
  MakeLag(problem, {-0.1, 0.2, 0.7});
  FitRequest request;
  request.bounds.push_back({"lag", {-1, 0}});
  const Fit fit(problem, request);
  Evaluator evaluator(fit.least_squares, {});
  EXPECT_EQ(Solve(fit, evaluator).stages.size(), 2u);
}

TEST(StatedStarts, ThreadsDoNotChangeTheAnswer) {
  FunctionProblem problem;
  MakeLag(problem, {-0.1, 0.2, 0.7});
  const Fit fit(problem);
  Evaluator one(fit.least_squares, {});
  Evaluator three(fit.least_squares, {});
  const SolverResult first = Solve(fit, one, 1);
  const SolverResult second = Solve(fit, three, 3);
  EXPECT_EQ(first.x, second.x);
  EXPECT_EQ(one.evaluations(), three.evaluations());
}

TEST(StatedStarts, SharesABudgetAmongTheStarts) {
  FunctionProblem problem;
  MakeLag(problem, {-0.1, 0.2, 0.7});
  const Fit fit(problem);
  Evaluator::Options options;
  options.budget.max_evaluations = 9;
  Evaluator evaluator(fit.least_squares, options);
  const SolverResult result = Solve(fit, evaluator);
  EXPECT_EQ(result.stop.kind, Termination::kMaxEvaluations) << result.stop.test;
  ASSERT_EQ(result.stages.size(), 4u);
  for (const Stage& stage : result.stages) EXPECT_LE(stage.evaluations, 2);
}

TEST(Parameters, OtherStartsLieWithinTheBounds) {
  Parameter lag = BaseParameter("lag", "s", "of a sine", -0.5, 0.5, 0);
  lag.other_starts = {0.1, 0.7};
  const Status status = CheckParameters({lag});
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().message,
            "parameter 'lag': one of its other starts, 0.7, lies outside its bounds -0.5 .. 0.5 [s]");
}

}  // namespace
}  // namespace sinew
