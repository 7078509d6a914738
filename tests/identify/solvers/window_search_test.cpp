// Nuisance values that continue from sample to sample, through a law with branches.
#include "identify/solvers/window_search.h"

#include <gtest/gtest.h>

#include "identify/solvers/local_fit.h"
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

}  // namespace
}  // namespace sinew
