// The search that ends when independent starts agree: how often it checks, and when it accepts.
#include "identify/solvers/independent_starts.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/constants.h"
#include "base/random.h"
#include "tests/identify/support/classic_problems.h"

namespace sinew {
namespace {

constexpr int kRecordSamples = 200;

// y = sin(w t) with noise: as a function of w the cost has a local minimum about every pi / 10.
void MakeSine(FunctionProblem& problem, double noise, double start) {
  problem.Add("w", 0, 20, start);
  Random random(7);
  std::vector<double> measured;
  for (int i = 0; i < kRecordSamples; ++i)
    measured.push_back(std::sin(9.3 * 0.05 * i) + noise * random.Normal());
  problem.AddBlock("t", measured, {0},
                   [](const Vector& p, Eigen::Ref<Vector> values, Matrix* derivatives) -> Status {
                     for (int i = 0; i < kRecordSamples; ++i) {
                       const double t = 0.05 * i;
                       values[i] = std::sin(p[0] * t);
                       if (derivatives != nullptr) (*derivatives)(i, 0) = t * std::cos(p[0] * t);
                     }
                     return {};
                   });
}

SolverResult Solve(const LeastSquares& fit, Evaluator& evaluator, int threads = 1) {
  SolverOptions options;
  options.threads = threads;
  return MakeSolver("restarts", options).value()->Solve(evaluator, fit.Start());
}

TEST(IndependentStarts, FindTheFrequencyFromFarAway) {
  for (const double start : {0.5, 4.0, 15.0, 19.5}) {
    FunctionProblem problem;
    MakeSine(problem, 0.1, start);
    const Fit fit(problem);
    Evaluator evaluator(fit.least_squares, {});
    const SolverResult result = Solve(fit.least_squares, evaluator);
    EXPECT_NEAR(fit.least_squares.Parameters(result.x)[0], 9.3, 0.01) << start;
    EXPECT_TRUE(result.stop.converged()) << result.stop.test;
    ASSERT_GE(result.stages.size(), 2u);
    EXPECT_LE(result.stages[0].cost, result.stages[1].cost);
  }
}

TEST(IndependentStarts, OneMinimumAndWhiteNoiseTakeFourLocalSearches) {
  FunctionProblem problem;
  Random random(3);
  std::vector<double> measured;
  for (int i = 0; i < kRecordSamples; ++i)
    measured.push_back(2 * std::exp(-0.01 * i) + 0.1 * random.Normal());
  problem.Add("a", 0, 10, 5).Add("b", 0, 0.1, 0.05);
  problem.AddBlock("t", measured, {0, 1},
                   [](const Vector& p, Eigen::Ref<Vector> values, Matrix* derivatives) -> Status {
                     for (int i = 0; i < kRecordSamples; ++i) {
                       const double decay = std::exp(-p[1] * i);
                       values[i] = p[0] * decay;
                       if (derivatives != nullptr) derivatives->row(i) << decay, -i * p[0] * decay;
                     }
                     return {};
                   });
  const Fit fit(problem);
  Evaluator evaluator(fit.least_squares, {});
  const SolverResult result = Solve(fit.least_squares, evaluator);
  EXPECT_EQ(result.stages.size(), 4u) << result.stop.test;
  EXPECT_LT(evaluator.evaluations(), 120);
  EXPECT_EQ(solvers::AgreementOf(result.stages).agreeing, 4);
}

TEST(IndependentStarts, AStartThatLeavesOnlyNoiseWhereRandomOnesFailIsEnough) {
  FunctionProblem problem;
  MakeSine(problem, 0.01, 9.25);
  const Fit fit(problem);
  Evaluator evaluator(fit.least_squares, {});
  const SolverResult result = Solve(fit.least_squares, evaluator);
  EXPECT_NEAR(fit.least_squares.Parameters(result.x)[0], 9.3, 0.001);
  EXPECT_EQ(result.stages.size(), 4U) << result.stop.test;
  EXPECT_LT(evaluator.evaluations(), 250);
}

TEST(IndependentStarts, NoiseThatHidesEverythingIsNotSearchedFurther) {
  FunctionProblem problem;
  MakeSine(problem, 30, 4.0);
  const Fit fit(problem);
  Evaluator evaluator(fit.least_squares, {});
  const SolverResult result = Solve(fit.least_squares, evaluator);
  EXPECT_EQ(result.stages.size(), 4U) << result.stop.test;
  EXPECT_LT(evaluator.evaluations(), 250);
}

TEST(IndependentStarts, WhatIsNotDeterminedKeepsItsGivenValue) {
  FunctionProblem problem;
  problem.Add("b", 0, 1, 0.375);
  Random random(5);
  std::vector<double> measured;
  for (int i = 0; i < kRecordSamples; ++i) measured.push_back(3 + 0.1 * random.Normal());
  problem.Add("a", 0, 10, 5);
  problem.AddBlock("t", measured, {0, 1},
                   [](const Vector& p, Eigen::Ref<Vector> values, Matrix* derivatives) -> Status {
                     values.setConstant(p[1]);
                     if (derivatives != nullptr) {
                       derivatives->col(0).setZero();
                       derivatives->col(1).setOnes();
                     }
                     return {};
                   });
  const Fit fit(problem);
  Evaluator evaluator(fit.least_squares, {});
  const SolverResult result = Solve(fit.least_squares, evaluator);
  EXPECT_NEAR(fit.least_squares.Parameters(result.x)[1], 3, 0.03);
  EXPECT_EQ(fit.least_squares.Parameters(result.x)[0], 0.375);
}

TEST(IndependentStarts, ExactDataEndAtOnce) {
  FunctionProblem problem;
  MakeSine(problem, 0, 9.2);
  const Fit fit(problem);
  Evaluator evaluator(fit.least_squares, {});
  const SolverResult result = Solve(fit.least_squares, evaluator);
  EXPECT_NE(result.stop.test.find("zero to rounding"), std::string::npos) << result.stop.test;
  EXPECT_LT(evaluator.evaluations(), 300);
}

TEST(IndependentStarts, ThreadsDoNotChangeAnswerOrTrace) {
  FunctionProblem problem;
  MakeSine(problem, 0.3, 4.0);
  const Fit fit(problem);
  Evaluator one(fit.least_squares, {});
  Evaluator three(fit.least_squares, {});
  const SolverResult a = Solve(fit.least_squares, one, 1);
  const SolverResult b = Solve(fit.least_squares, three, 3);
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.stop.test, b.stop.test);
  ASSERT_EQ(one.trace().size(), three.trace().size());
  for (std::size_t i = 0; i < one.trace().size(); ++i) ASSERT_EQ(one.trace()[i].x, three.trace()[i].x) << i;
}

TEST(IndependentStarts, ABudgetIsKept) {
  FunctionProblem problem;
  MakeSine(problem, 0.3, 4.0);
  const Fit fit(problem);
  for (const long budget : {1L, 7L, 50L, 300L}) {
    Evaluator::Options options;
    options.budget.max_evaluations = budget;
    Evaluator evaluator(fit.least_squares, options);
    const SolverResult result = Solve(fit.least_squares, evaluator);
    EXPECT_LE(evaluator.evaluations(), budget);
    EXPECT_TRUE(result.stop.usable());
    if (evaluator.evaluations() == budget) {
      EXPECT_EQ(result.stop.kind, Termination::kMaxEvaluations);
    }
  }
}

TEST(Agreement, CountsCostsWithinATenthOfAPercent) {
  const auto end = [](double cost) {
    Stage stage;
    stage.cost = cost;
    return stage;
  };
  const solvers::Agreement agreement =
      solvers::AgreementOf({end(1.0005), end(2.0), end(1.0), end(kInfinity), end(1.12)});
  EXPECT_EQ(agreement.starts, 5);
  EXPECT_EQ(agreement.agreeing, 2);
  EXPECT_DOUBLE_EQ(agreement.next_best, 1.12);
  EXPECT_EQ(solvers::AgreementOf({end(kInfinity)}).agreeing, 0);
}

}  // namespace
}  // namespace sinew
