// Minima that differ in a stretch of time.
#include "identify/solvers/redrawn_stretches.h"

#include <gtest/gtest.h>

#include "identify/solvers/local_fit.h"
#include "identify/solvers/marginal_cost.h"
#include "identify/solvers/time_factors.h"
#include "tests/identify/support/random_walk.h"

namespace sinew {
namespace {

// A walk whose speed is known, and where a search of the whole trial at once ends.
struct Walk {
  explicit Walk(std::uint64_t seed) {
    problem.Add("speed", 0.1, 0.5, kWalkSpeed);
    steps = AddRandomWalk(problem, "t", 1, seed);
    setup = MakeFitSetup(problem, {{}, {{"speed", kWalkSpeed}}, {}, {}, {}}).value();
  }
  [[nodiscard]] solvers::WindowEnd AtOnce(const LeastSquares& fit) const {
    const auto local = solvers::LocalFit(fit).Minimize(fit.Start(), -1, {0, 1e-9}, 500);
    return {local.x, local.cost, solvers::MarginalCost(fit, local.x)};
  }
  FunctionProblem problem;
  std::vector<double> steps;
  FitSetup setup;
};

TEST(RedrawnStretches, RepairWhatASearchOfTheWholeTrialMisses) {
  constexpr int kTrials = 8;
  int at_once = 0;
  int redrawn = 0;
  for (int seed = 1; seed <= kTrials; ++seed) {
    const Walk walk(static_cast<std::uint64_t>(seed));
    const LeastSquares fit(walk.problem, walk.setup);
    const solvers::WindowEnd from = walk.AtOnce(fit);
    const solvers::WindowEnd found = solvers::RedrawStretches(fit, from, {}, {});
    EXPECT_LE(found.marginal, from.marginal);
    EXPECT_EQ(found.marginal, solvers::MarginalCost(fit, found.x));
    at_once += AngleError(fit.Parameters(from.x), 1, walk.steps) < 1 ? 1 : 0;
    redrawn += AngleError(fit.Parameters(found.x), 1, walk.steps) < 1 ? 1 : 0;
  }
  std::printf("of %d trials %d at once, %d with stretches redrawn\n", kTrials, at_once, redrawn);
  EXPECT_LE(at_once, kTrials / 4);
  EXPECT_GE(redrawn, kTrials - 2);
}

TEST(RedrawnStretches, AreTheSameWithAnyNumberOfThreads) {
  const Walk walk(3);
  const LeastSquares fit(walk.problem, walk.setup);
  const solvers::WindowEnd from = walk.AtOnce(fit);
  const solvers::WindowEnd one = solvers::RedrawStretches(fit, from, {5, 1}, {});
  EXPECT_NE(one.x, from.x);
  EXPECT_EQ(one.x, solvers::RedrawStretches(fit, from, {5, 2}, {}).x);
}

// A linear fit has one minimum: where a stretch is on its way back to it, the search ends.
TEST(RedrawnStretches, AReturnToTheMinimumIsNotSearchedToTheEnd) {
  constexpr int kSamples = 40;
  constexpr int kRedraws = 16;
  long predictions = 0;
  FunctionProblem problem;
  Random random(2);
  std::vector<double> measured;
  std::vector<int> columns;
  double level = 0;
  for (int i = 0; i < kSamples; ++i) {
    Parameter b = BaseParameter("b" + std::to_string(i), "1", "", -8, 8, 0);
    b.kind = ParameterKind::kNuisance;
    b.trial = "t";
    b.prior = GaussianPrior{0, 1};
    problem.Add(std::move(b));
    columns.push_back(i);
    level += random.Normal();
    measured.push_back(10 * level + random.Normal());
  }
  problem.AddBlock("t", measured, columns,
                   [&](const Vector& p, Eigen::Ref<Vector> predicted, Matrix* derivatives) -> Status {
                     ++predictions;
                     double sum = 0;
                     for (int i = 0; i < kSamples; ++i) {
                       sum += 10 * p[i];
                       predicted[i] = sum;
                       if (derivatives != nullptr) derivatives->row(i).head(i + 1).setConstant(10);
                     }
                     return {};
                   });
  const FitSetup setup = MakeFitSetup(problem, {}).value();
  const LeastSquares fit(problem, setup);
  const auto local = solvers::LocalFit(fit).Minimize(fit.Start(), -1, {0, 1e-12}, 100);
  predictions = 0;
  const solvers::WindowEnd from{local.x, local.cost, solvers::MarginalCost(fit, local.x)};
  solvers::Redraws how;
  how.idle = kRedraws;
  EXPECT_EQ(solvers::RedrawStretches(fit, from, how, {}).x, from.x);
  EXPECT_LT(predictions, 16 * kRedraws);  // 20 if each is searched to the end
}

TEST(RedrawnStretches, AStopLeavesTheMinimumAsItIs) {
  const Walk walk(3);
  const LeastSquares fit(walk.problem, walk.setup);
  const solvers::WindowEnd from = walk.AtOnce(fit);
  EXPECT_EQ(solvers::RedrawStretches(fit, from, {5, 1}, [] { return true; }).x, from.x);
}

TEST(TimeFactors, CountTimeWithinEachTrial) {
  FunctionProblem problem;
  problem.Add("speed", 0.1, 0.5, kWalkSpeed);
  (void)AddRandomWalk(problem, "a", 1, 3);
  (void)AddRandomWalk(problem, "b", 1 + kWalkSamples / 2, 4);
  const FitSetup setup = MakeFitSetup(problem, {}).value();
  const LeastSquares fit(problem, setup);
  solvers::TimeFactors factors(fit);
  ASSERT_EQ(factors.shares().size(), 2U);
  for (const Vector& shares : factors.shares()) {
    EXPECT_EQ(shares[0], 0);
    EXPECT_EQ(shares[kWalkSamples - 1], 1);
  }
  Matrix rows = Matrix::Ones(kWalkSamples, 1);
  factors.Apply(1, rows);
  EXPECT_EQ(rows, Matrix::Ones(kWalkSamples, 1)) << "before anything is set";
  EXPECT_EQ(factors.trials(), 2U);
  factors.Set([](std::size_t trial, double share) { return trial == 0 ? 1.0 : share < 0.5 ? 0.0 : 2.0; });
  factors.Apply(1, rows);
  EXPECT_EQ(rows(0, 0), 0);
  EXPECT_EQ(rows(kWalkSamples - 1, 0), 2);
  Matrix others = Matrix::Ones(kWalkSamples, 1);
  factors.Apply(0, others);
  EXPECT_EQ(others, Matrix::Ones(kWalkSamples, 1));
}

}  // namespace
}  // namespace sinew
