// Nuisance values that continue from sample to sample, through a law with branches.
#include "identify/solvers/window_search.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "base/random.h"
#include "identify/solvers/local_fit.h"
#include "tests/identify/support/classic_problems.h"

namespace sinew {
namespace {

constexpr int kWandererSamples = 60;
constexpr double kWandererNoise = 0.01;
constexpr double kStep = 0.35;  // [rad] of the wandering phase every second sample
constexpr double kSpeed = 0.4;  // [rad] a sample

// y = sin(speed i + phase), where the phase wanders by a normal step every second sample: over a trial it
// goes through several periods, which only those next to each other tell apart. @return the true steps
std::vector<double> AddWanderer(FunctionProblem& problem, const std::string& trial, int first_column,
                                std::uint64_t seed) {
  constexpr int kSteps = kWandererSamples / 2;
  std::vector<int> columns{0};
  for (int k = 0; k < kSteps; ++k) {
    Parameter p;
    p.name = "step" + std::to_string(k) + "@" + trial;
    p.unit = "1";
    p.lower = -8;
    p.upper = 8;
    p.start = 0;
    p.kind = ParameterKind::kNuisance;
    p.trial = trial;
    p.prior = GaussianPrior{0, 1};
    columns.push_back(first_column + k);
    problem.Add(std::move(p));
  }
  Random random(seed);
  std::vector<double> steps;
  std::vector<double> measured;
  double phase = 0;
  for (int i = 0; i < kWandererSamples; ++i) {
    if (i % 2 == 0) {
      steps.push_back(random.Normal());
      phase += kStep * steps.back();
    }
    measured.push_back((std::sin(kSpeed * i + phase) + kWandererNoise * random.Normal()) / kWandererNoise);
  }
  problem.AddBlock(
      trial, measured, columns,
      [first_column](const Vector& p, Eigen::Ref<Vector> predicted, Matrix* derivatives) -> Status {
        double angle = 0;
        for (int i = 0; i < kWandererSamples; ++i) {
          if (i % 2 == 0) angle += kStep * p[first_column + i / 2];
          predicted[i] = std::sin(p[0] * i + angle) / kWandererNoise;
          if (derivatives == nullptr) continue;
          const double slope = std::cos(p[0] * i + angle) / kWandererNoise;
          (*derivatives)(i, 0) = slope * i;
          for (int k = 0; k <= i / 2; ++k) (*derivatives)(i, first_column + k) = slope * kStep;
        }
        return {};
      });
  return steps;
}

// Largest error of the phase at any sample [rad].
double PhaseError(const Vector& parameters, int first_column, const std::vector<double>& steps) {
  double error = 0;
  double largest = 0;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    error += kStep * (parameters[first_column + static_cast<int>(k)] - steps[k]);
    largest = std::max(largest, std::abs(error));
  }
  return largest;
}

TEST(WindowSearch, FollowsBranchesThatAllSamplesAtOnceMiss) {
  int by_windows = 0;
  int at_once = 0;
  constexpr int kTrials = 8;
  for (int seed = 1; seed <= kTrials; ++seed) {
    FunctionProblem problem;
    problem.Add("speed", 0.1, 0.5, kSpeed);
    const std::vector<double> steps = AddWanderer(problem, "t", 1, static_cast<std::uint64_t>(seed));
    FitSetup setup = MakeFitSetup(problem, {{}, {{"speed", kSpeed}}, {}, {}, {}}).value();
    LeastSquares fit(problem, setup);
    const Vector start = fit.Start();
    const auto local = solvers::LocalFit(fit).Minimize(start, -1, {0, 1e-9}, 500);
    const solvers::WindowEnd found = solvers::SearchInWindows(fit, start, {}, nullptr);
    at_once += PhaseError(fit.Parameters(local.x), 1, steps) < 1 ? 1 : 0;
    by_windows += PhaseError(fit.Parameters(found.x), 1, steps) < 1 ? 1 : 0;
  }
  std::printf("of %d trials %d by windows, %d at once\n", kTrials, by_windows, at_once);
  EXPECT_GE(by_windows, kTrials - 2);
  EXPECT_LE(at_once, kTrials / 4);
}

TEST(WindowSearch, TrialsAreSearchedOneByOneWithAnyNumberOfThreads) {
  FunctionProblem problem;
  problem.Add("speed", 0.1, 0.5, kSpeed);
  const std::vector<double> first = AddWanderer(problem, "a", 1, 3);
  const std::vector<double> second = AddWanderer(problem, "b", 1 + kWandererSamples / 2, 4);
  const FitSetup setup = MakeFitSetup(problem, {}).value();
  const LeastSquares fit(problem, setup);
  const Vector found = solvers::SearchTrials(fit, fit.Start(), {}, 1, nullptr);
  EXPECT_EQ(found, solvers::SearchTrials(fit, fit.Start(), {}, 2, nullptr));
  EXPECT_LT(PhaseError(fit.Parameters(found), 1, first), 1);
  EXPECT_LT(PhaseError(fit.Parameters(found), 1 + kWandererSamples / 2, second), 1);
  EXPECT_EQ(fit.Parameters(found)[0], kSpeed);
}

TEST(WindowSearch, AnInterruptEndsItWhereItBegan) {
  FunctionProblem problem;
  problem.Add("speed", 0.1, 0.5, kSpeed);
  (void)AddWanderer(problem, "a", 1, 3);
  const FitSetup setup = MakeFitSetup(problem, {}).value();
  const LeastSquares fit(problem, setup);
  const std::atomic<bool> interrupt{true};
  EXPECT_EQ(solvers::SearchTrials(fit, fit.Start(), {}, 1, &interrupt), fit.Start());
}

TEST(WindowSearch, RestartsFindThePeriodBesideIt) {
  FunctionProblem problem;
  problem.Add("speed", 0.1, 0.5, 0.33);
  const std::vector<double> first = AddWanderer(problem, "a", 1, 3);
  (void)AddWanderer(problem, "b", 1 + kWandererSamples / 2, 4);
  const Fit fit(problem);
  Evaluator evaluator(fit.least_squares, {});
  const SolverResult result = MakeSolver("restarts", {}).value()->Solve(evaluator, fit.least_squares.Start());
  EXPECT_TRUE(result.stop.converged()) << result.stop.test;
  EXPECT_EQ(result.cost, result.stages.front().cost);
  EXPECT_NEAR(fit.least_squares.Parameters(result.x)[0], kSpeed, 0.05);
  auto workspace = fit.least_squares.NewWorkspace();
  EXPECT_DOUBLE_EQ(*fit.least_squares.Cost(result.x, workspace), result.cost);
}

}  // namespace
}  // namespace sinew
