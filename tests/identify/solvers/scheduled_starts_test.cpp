// Solver `restarts` where nuisance parameters have priors.
#include "identify/solvers/scheduled_starts.h"

#include <gtest/gtest.h>

#include "tests/identify/support/random_walk.h"

namespace sinew {
namespace {

TEST(ScheduledStarts, FindThePeriodBesideIt) {
  FunctionProblem problem;
  problem.Add("speed", 0.1, 0.5, 0.33);
  const std::vector<double> first = AddRandomWalk(problem, "a", 1, 3);
  (void)AddRandomWalk(problem, "b", 1 + kWalkSamples / 2, 4);
  const Fit fit(problem);
  Evaluator evaluator(fit.least_squares, {});
  const SolverResult result = MakeSolver("restarts", {}).value()->Solve(evaluator, fit.least_squares.Start());
  EXPECT_TRUE(result.stop.converged()) << result.stop.test;
  EXPECT_EQ(result.cost, result.stages.front().cost);
  EXPECT_NEAR(fit.least_squares.Parameters(result.x)[0], kWalkSpeed, 0.05);
  auto workspace = fit.least_squares.NewWorkspace();
  EXPECT_DOUBLE_EQ(*fit.least_squares.Cost(result.x, workspace), result.cost);
}

// y_k = scale b_k with b_k standard normal, and a channel with minima at scales 1 and 40: at 40 hardly any b
// is needed, so that the cost is lower, but hardly any b fits.
TEST(ScheduledStarts, TakeTheMoreProbableOfTwoMinima) {
  constexpr int kValues = 16;
  constexpr double kUpper = 40;
  FunctionProblem problem;
  problem.Add("scale", 0.1, 100, 6);
  Random random(5);
  std::vector<double> measured;
  std::vector<int> columns{0};
  for (int k = 0; k < kValues; ++k) {
    Parameter b;
    b.name = "b" + std::to_string(k);
    b.unit = "1";
    b.lower = -20;
    b.upper = 20;
    b.kind = ParameterKind::kNuisance;
    b.trial = "t";
    b.prior = GaussianPrior{0, 1};
    problem.Add(std::move(b));
    columns.push_back(1 + k);
    measured.push_back(random.Normal() / kWalkNoise);
  }
  problem.AddBlock("t", measured, columns,
                   [](const Vector& p, Eigen::Ref<Vector> predicted, Matrix* derivatives) -> Status {
                     for (int k = 0; k < kValues; ++k) {
                       predicted[k] = p[0] * p[1 + k] / kWalkNoise;
                       if (derivatives == nullptr) continue;
                       (*derivatives)(k, 0) = p[1 + k] / kWalkNoise;
                       (*derivatives)(k, 1 + k) = p[0] / kWalkNoise;
                     }
                     return {};
                   });
  problem.AddBlock("scale", {0}, {0},
                   [](const Vector& p, Eigen::Ref<Vector> predicted, Matrix* derivatives) -> Status {
                     const double near = std::log(p[0]);
                     const double far = std::log(p[0] / kUpper);
                     predicted[0] = 20 * near * far;
                     if (derivatives != nullptr) (*derivatives)(0, 0) = 20 * (near + far) / p[0];
                     return {};
                   });
  const Fit fit(problem);
  Evaluator evaluator(fit.least_squares, {});
  const SolverResult result = MakeSolver("restarts", {}).value()->Solve(evaluator, fit.least_squares.Start());
  EXPECT_NEAR(fit.least_squares.Parameters(result.x)[0], 1, 0.2) << result.stop.test;
  double lowest = result.cost;
  for (const Stage& stage : result.stages) lowest = std::min(lowest, stage.cost);
  EXPECT_LT(lowest, result.cost - 1) << "no search ended at the narrow minimum, so that nothing was chosen";
}

}  // namespace
}  // namespace sinew
