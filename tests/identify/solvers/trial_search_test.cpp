// Trials one by one, and all together with what they have in common.
#include "identify/solvers/trial_search.h"

#include <gtest/gtest.h>

#include <limits>

#include "identify/execution/fit_record.h"
#include "identify/solvers/local_fit.h"
#include "identify/solvers/marginal_cost.h"
#include "tests/identify/support/random_walk.h"

namespace sinew {
namespace {

TEST(TrialSearch, TrialsAreSearchedOneByOneWithAnyNumberOfThreads) {
  FunctionProblem problem;
  problem.Add("speed", 0.1, 0.5, kWalkSpeed);
  const std::vector<double> first = AddRandomWalk(problem, "a", 1, 3);
  const std::vector<double> second = AddRandomWalk(problem, "b", 1 + kWalkSamples / 2, 4);
  const FitSetup setup = MakeFitSetup(problem, {}).value();
  const LeastSquares fit(problem, setup);
  const Vector found = solvers::SearchTrials(fit, fit.Start(), {1, 1, true, {}}, {});
  EXPECT_EQ(found, solvers::SearchTrials(fit, fit.Start(), {1, 2, true, {}}, {}));
  EXPECT_LT(AngleError(fit.Parameters(found), 1, first), 1);
  EXPECT_LT(AngleError(fit.Parameters(found), 1 + kWalkSamples / 2, second), 1);
  EXPECT_EQ(fit.Parameters(found)[0], kWalkSpeed);
}

TEST(TrialSearch, AStopEndsItWhereItBegan) {
  FunctionProblem problem;
  problem.Add("speed", 0.1, 0.5, kWalkSpeed);
  (void)AddRandomWalk(problem, "a", 1, 3);
  const FitSetup setup = MakeFitSetup(problem, {}).value();
  const LeastSquares fit(problem, setup);
  EXPECT_EQ(solvers::SearchTrials(fit, fit.Start(), {1, 1, true, {}}, [] { return true; }), fit.Start());
}

constexpr double kNever = -std::numeric_limits<double>::infinity();

// Two trials whose speed is wrong as well: no search of a single trial at that speed finds the truth.
struct TwoWalks {
  TwoWalks() {
    problem.Add("speed", 0.1, 0.5, 0.33);
    (void)AddRandomWalk(problem, "a", 1, 3);
    (void)AddRandomWalk(problem, "b", 1 + kWalkSamples / 2, 4);
  }
  FunctionProblem problem;
};

solvers::WindowEnd AtOnce(const LeastSquares& fit) {
  const auto local = solvers::LocalFit(fit).Minimize(fit.Start(), -1, {0, 1e-9}, 500);
  return {local.x, local.cost, solvers::MarginalCost(fit, local.x)};
}

TEST(TrialSearch, RedrawnWithTheSpeedFreeItEndsLower) {
  const TwoWalks walks;
  FitSetup setup = MakeFitSetup(walks.problem, {}).value();
  FitRecord record;
  setup.record = &record;
  const LeastSquares fit(walks.problem, setup);
  const solvers::WindowEnd end = AtOnce(fit);
  const std::size_t before = record.size();
  const solvers::WindowEnd found = solvers::RedrawTrials(fit, end, 1, 1, kNever, {});
  EXPECT_LT(found.cost, 0.5 * end.cost);
  EXPECT_EQ(found.marginal, solvers::MarginalCost(fit, found.x));
  EXPECT_EQ(record.size(), before + 1) << "the answer as a whole is kept, its fits are not";

  const solvers::WindowEnd kept = solvers::RedrawTrials(fit, end, 1, 2, kNever, {});
  EXPECT_EQ(kept.x, found.x);
  EXPECT_EQ(kept.cost, found.cost);
  EXPECT_EQ(kept.marginal, found.marginal);
  EXPECT_EQ(record.size(), before + 1);
}

TEST(TrialSearch, RedrawnUntilThatIsEnough) {
  const TwoWalks walks;
  const FitSetup setup = MakeFitSetup(walks.problem, {}).value();
  const LeastSquares fit(walks.problem, setup);
  const solvers::WindowEnd end = AtOnce(fit);
  const double all = solvers::RedrawTrials(fit, end, 1, 1, kNever, {}).marginal;
  const double enough = 0.5 * (all + end.marginal);
  const double found = solvers::RedrawTrials(fit, end, 1, 1, enough, {}).marginal;
  EXPECT_LE(found, enough);
  EXPECT_GT(found, all);
}

TEST(TrialSearch, AnInterruptedSearchOfAllTrialsIsNotKept) {
  const TwoWalks walks;
  FitSetup setup = MakeFitSetup(walks.problem, {}).value();
  FitRecord record;
  setup.record = &record;
  const LeastSquares fit(walks.problem, setup);
  const Vector start = fit.Start();
  const solvers::WindowEnd found =
      solvers::RedrawTrials(fit, {start, 1, 1}, 1, 1, kNever, [] { return true; });
  EXPECT_EQ(found.x, start);
  EXPECT_EQ(record.size(), 0U);
}

}  // namespace
}  // namespace sinew
