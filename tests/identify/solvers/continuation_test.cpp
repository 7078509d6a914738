// A search at falling noise levels, on a curve that hundreds of nuisance values could bend.
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "identify/solvers/solver.h"
#include "tests/identify/support/classic_problems.h"

namespace sinew {
namespace {

constexpr int kClockSamples = 60;
constexpr double kClockNoise = 0.002;

// y = sin(2 pi (t + d(t)) / T), where the clock's error d(t) has a nuisance value at every fourth sample,
// with a prior of a tenth of a period: they can follow any period, each sample by a branch of the arcsine of
// its own.
void MakeClock(FunctionProblem& problem, double start, bool with_errors = true) {
  problem.Add("period", 0.5, 2, start);
  std::vector<int> columns{0};
  const int values = with_errors ? kClockSamples / 4 : 0;
  for (int k = 0; k < values; ++k) {
    Parameter p;
    p.name = "d" + std::to_string(k);
    p.unit = "s";
    p.lower = -1;
    p.upper = 1;
    p.start = 0;
    p.kind = ParameterKind::kNuisance;
    p.trial = "t";
    p.prior = GaussianPrior{0, 0.05};
    columns.push_back(k + 1);
    problem.Add(std::move(p));
  }
  Random random(4);
  std::vector<double> measured;
  double error = 0;
  for (int i = 0; i < kClockSamples; ++i) {
    if (i % 4 == 0) error = 0.03 * random.Normal();
    measured.push_back((std::sin(2 * M_PI * (0.05 * i + error)) + kClockNoise * random.Normal()) /
                       kClockNoise);
  }
  problem.AddBlock("t", measured, columns,
                   [values](const Vector& p, Eigen::Ref<Vector> predicted, Matrix* derivatives) -> Status {
                     for (int i = 0; i < kClockSamples; ++i) {
                       const double at = 0.05 * i + (values > 0 ? p[1 + i / 4] : 0);
                       const double phase = 2 * M_PI * at / p[0];
                       predicted[i] = std::sin(phase) / kClockNoise;
                       if (derivatives == nullptr) continue;
                       const double slope = std::cos(phase) * 2 * M_PI / p[0] / kClockNoise;
                       (*derivatives)(i, 0) = -slope * at / p[0];
                       if (values > 0) (*derivatives)(i, 1 + i / 4) = slope;
                     }
                     return {};
                   });
}

SolverResult Solve(const std::string& solver, const FunctionProblem& problem) {
  const Fit fit(problem);
  Evaluator evaluator(fit.least_squares, {});
  return MakeSolver(solver, {}).value()->Solve(evaluator, fit.least_squares.Start());
}

TEST(Continuation, FindsWhatALocalSearchMissesFromMoreStarts) {
  int by_continuation = 0;
  int by_lm = 0;
  constexpr int kStarts = 15;
  for (int i = 0; i < kStarts; ++i) {
    FunctionProblem problem;
    MakeClock(problem, 0.85 + 0.025 * i);
    const Fit fit(problem);
    const SolverResult staged = Solve("continuation", problem);
    const SolverResult local = Solve("lm", problem);
    EXPECT_TRUE(staged.stop.converged()) << staged.stop.test;
    by_continuation += std::abs(fit.least_squares.Parameters(staged.x)[0] - 1) < 0.02 ? 1 : 0;
    by_lm += std::abs(fit.least_squares.Parameters(local.x)[0] - 1) < 0.02 ? 1 : 0;
  }
  std::printf("of %d starts %d by continuation, %d by lm\n", kStarts, by_continuation, by_lm);
  EXPECT_GE(by_continuation, kStarts - 1);
  EXPECT_GT(by_continuation, by_lm + 2);
}

TEST(Continuation, RestartsUseItWhereNuisanceValuesHavePriors) {
  for (const bool with_errors : {true, false}) {
    FunctionProblem problem;
    MakeClock(problem, 0.97, with_errors);
    const SolverResult result = Solve("restarts", problem);
    ASSERT_FALSE(result.stages.empty());
    EXPECT_EQ(result.stages.front().solver, with_errors ? "continuation" : "lm");
  }
}

TEST(Continuation, WithoutPriorsItIsTheLocalSearch) {
  FunctionProblem problem;
  MakeClock(problem, 0.97, false);
  const SolverResult staged = Solve("continuation", problem);
  const SolverResult local = Solve("lm", problem);
  EXPECT_EQ(staged.x, local.x);
  EXPECT_EQ(staged.cost, local.cost);
}

}  // namespace
}  // namespace sinew
