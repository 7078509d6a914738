#include "identify/solvers/annealing.h"

#include <gtest/gtest.h>

#include "identify/solvers/simulated_annealing.h"
#include "tests/identify/support/classic_problems.h"
#include "tests/identify/support/ranmar.h"

namespace sinew {
namespace {

// simann.f 3.2 as published (its Judge example: T = 5, RT = 0.5, NS = 20, NT = 5, seeds 1 and 2), compiled
// with gfortran 12, prints these figures.
constexpr long kPublishedEvaluations = 5001;
constexpr long kPublishedAccepted = 2263;
constexpr long kPublishedOutOfBounds = 0;
constexpr double kPublishedOptimum = 16.08173068624;
constexpr double kPublishedFinalTemperature = 0.2980232238770e-6;
// Its constants .6 and .4 are single precision: the steps are adjusted by 1e-8 differently, and the last
// digits of the optimum, which is flat, follow.
constexpr double kSinglePrecisionConstants = 1e-10;
// The same program with .6D0 and .4D0 in that place ends here.
constexpr double kXInDouble[2] = {0.86479306394794575, 1.2357467408709701};
constexpr double kRounding = 1e-14;

solvers::AnnealingSchedule PublishedSchedule() {
  solvers::AnnealingSchedule schedule;
  schedule.temperature = 5;
  schedule.cooling = 0.5;
  schedule.cycles = 20;
  schedule.adjustments = 5;
  schedule.tolerance = 1e-6;
  schedule.step = Vector::Ones(2);
  return schedule;
}

TEST(Annealing, ReproducesThePublishedRun) {
  const Vector start = Vector::Map(Judge::kStart, 2);
  const Vector far = Vector::Constant(2, 1e25);
  Ranmar ranmar(1, 2);
  const solvers::AnnealingResult result = solvers::Anneal(
      [](const Vector& x, double& cost) {
        cost = Judge::Value(x);
        return true;
      },
      -far, far, start, Judge::Value(start), PublishedSchedule(), [&ranmar] { return double{ranmar()}; });

  EXPECT_TRUE(result.annealed);
  EXPECT_EQ(result.moves + 1, kPublishedEvaluations);  // it counts the start
  EXPECT_EQ(result.accepted, kPublishedAccepted);
  EXPECT_EQ(result.out_of_bounds, kPublishedOutOfBounds);
  EXPECT_NEAR(result.cost, kPublishedOptimum, kSinglePrecisionConstants);
  EXPECT_NEAR(result.x[0], kXInDouble[0], kRounding);
  EXPECT_NEAR(result.x[1], kXInDouble[1], kRounding);
  EXPECT_NEAR(result.temperature, kPublishedFinalTemperature, 1e-12 * kPublishedFinalTemperature);
}

// What James (1990) gives to check an implementation with: after 20,000 numbers from the seeds 1802 and 9373,
// these six, times 4096^2.
TEST(Ranmar, GivesThePublishedNumbers) {
  Ranmar ranmar(1802, 9373);
  for (int i = 0; i < 20000; ++i) ranmar();
  for (const float expected : {6533892.f, 14220222.f, 7275067.f, 6172232.f, 8354498.f, 10633180.f}) {
    EXPECT_EQ(ranmar() * 4096 * 4096, expected);
  }
}

TEST(Annealing, RedrawsTrialsInsideTheBounds) {
  const Vector lower = Vector::Constant(1, 2);
  const Vector upper = Vector::Constant(1, 3);
  solvers::AnnealingSchedule schedule;
  schedule.step = Vector::Constant(1, 100);  // nearly every trial is outside at first
  Ranmar ranmar(1, 2);
  long outside = 0;
  const solvers::AnnealingResult result = solvers::Anneal(
      [&](const Vector& x, double& cost) {
        if (x[0] < 2 || x[0] > 3) ++outside;
        cost = x[0];
        return true;
      },
      lower, upper, upper, 3, schedule, [&ranmar] { return double{ranmar()}; });
  EXPECT_EQ(outside, 0);
  EXPECT_GT(result.out_of_bounds, 0);
  EXPECT_NEAR(result.cost, 2, 1e-4);  // a linear cost: the last steps are about as long as the tolerance
}

TEST(SimulatedAnnealing, PublishedScheduleWhenTheBudgetAllows) {
  const solvers::AnnealingSchedule schedule = solvers::ScheduleFor(5, 1000000000);
  EXPECT_EQ(schedule.cycles, 20);
  EXPECT_EQ(schedule.adjustments, 100);
  EXPECT_EQ(schedule.cooling, 0.85);
  EXPECT_EQ(solvers::ScheduleFor(30, 1000000000).adjustments, 150);
}

TEST(SimulatedAnnealing, SmallBudgetsStillCoolDown) {
  for (const int n : {1, 2, 5, 20}) {
    for (const long budget : {1000, 5000, 100000}) {
      const solvers::AnnealingSchedule schedule = solvers::ScheduleFor(n, budget);
      const double per_temperature = 1.0 * n * schedule.cycles * schedule.adjustments;
      const double fall = std::pow(schedule.cooling, static_cast<double>(budget) / per_temperature);
      EXPECT_LT(fall, 1e-5) << n << " variables, " << budget << " moves";
    }
  }
}

TEST(SimulatedAnnealing, FindsTheGlobalMinimumFromTheLocalOne) {
  FunctionProblem problem;
  Judge::MakeProblem(problem);
  const Fit fit(problem);
  Evaluator::Options options;
  options.budget.max_evaluations = 5000;
  Evaluator evaluator(fit.least_squares, options);
  const SolverResult result = solvers::SimulatedAnnealing(1).Solve(evaluator, fit.least_squares.Start());
  // 1e-5: what is left of the temperature's fall by 1e-6 from a few hundred.
  EXPECT_NEAR(2 * result.cost, Judge::kOptimum, 1e-5);
}

TEST(SimulatedAnnealing, ReportsTheTerminationTest) {
  FunctionProblem problem;
  Judge::MakeProblem(problem);
  const Fit fit(problem);
  Evaluator evaluator(fit.least_squares, {});
  const SolverResult result = solvers::SimulatedAnnealing(1).Solve(evaluator, fit.least_squares.Start());
  EXPECT_EQ(result.stop.kind, Termination::kAnnealed);
  EXPECT_NE(result.stop.test.find("4 temperatures agree within"), std::string::npos) << result.stop.test;
}

}  // namespace
}  // namespace sinew
