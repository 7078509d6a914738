// Nuisance values that continue from sample to sample, through a law with branches.
#include "identify/solvers/window_search.h"

#include <gtest/gtest.h>

#include "identify/solvers/local_fit.h"
#include "identify/solvers/solver.h"
#include "tests/identify/support/random_walk.h"

namespace sinew {
namespace {

TEST(WindowSearch, FollowsBranchesThatAllSamplesAtOnceMiss) {
  int by_windows = 0;
  int at_once = 0;
  constexpr int kTrials = 8;
  for (int seed = 1; seed <= kTrials; ++seed) {
    FunctionProblem problem;
    problem.Add("speed", 0.1, 0.5, kWalkSpeed);
    const std::vector<double> steps = AddRandomWalk(problem, "t", 1, static_cast<std::uint64_t>(seed));
    FitSetup setup = MakeFitSetup(problem, {{}, {{"speed", kWalkSpeed}}, {}, {}, {}}).value();
    LeastSquares fit(problem, setup);
    const Vector start = fit.Start();
    const auto local = solvers::LocalFit(fit).Minimize(start, -1, {0, 1e-9}, 500);
    const solvers::WindowEnd found = solvers::SearchInWindows(fit, start, {}, {});
    at_once += AngleError(fit.Parameters(local.x), 1, steps) < 1 ? 1 : 0;
    by_windows += AngleError(fit.Parameters(found.x), 1, steps) < 1 ? 1 : 0;
  }
  std::printf("of %d trials %d by windows, %d at once\n", kTrials, by_windows, at_once);
  EXPECT_GE(by_windows, kTrials - 2);
  EXPECT_LE(at_once, kTrials / 4);
}

TEST(WindowSearch, TrialsAreSearchedOneByOneWithAnyNumberOfThreads) {
  FunctionProblem problem;
  problem.Add("speed", 0.1, 0.5, kWalkSpeed);
  const std::vector<double> first = AddRandomWalk(problem, "a", 1, 3);
  const std::vector<double> second = AddRandomWalk(problem, "b", 1 + kWalkSamples / 2, 4);
  const FitSetup setup = MakeFitSetup(problem, {}).value();
  const LeastSquares fit(problem, setup);
  const Vector found = solvers::SearchTrials(fit, fit.Start(), {}, 1, {});
  EXPECT_EQ(found, solvers::SearchTrials(fit, fit.Start(), {}, 2, {}));
  EXPECT_LT(AngleError(fit.Parameters(found), 1, first), 1);
  EXPECT_LT(AngleError(fit.Parameters(found), 1 + kWalkSamples / 2, second), 1);
  EXPECT_EQ(fit.Parameters(found)[0], kWalkSpeed);
}

TEST(WindowSearch, AStopEndsItWhereItBegan) {
  FunctionProblem problem;
  problem.Add("speed", 0.1, 0.5, kWalkSpeed);
  (void)AddRandomWalk(problem, "a", 1, 3);
  const FitSetup setup = MakeFitSetup(problem, {}).value();
  const LeastSquares fit(problem, setup);
  EXPECT_EQ(solvers::SearchTrials(fit, fit.Start(), {}, 1, [] { return true; }), fit.Start());
}

TEST(WindowSearch, RestartsFindThePeriodBesideIt) {
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
TEST(WindowSearch, RestartsTakeTheMoreProbableOfTwoMinima) {
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
