#include "identify/solvers/residual_whitening.h"

#include <gtest/gtest.h>

#include <vector>

#include "base/random.h"
#include "tests/identify/support/function_problem.h"

namespace sinew {
namespace {

// One level, measured with an error that changes slowly.
void AddSlowError(FunctionProblem& problem, const std::string& trial, double deviation, std::uint64_t seed) {
  Random random(seed);
  std::vector<double> measured;
  double error = 0;
  for (int i = 0; i < 2000; ++i) {
    error = 0.98 * error + deviation * random.Normal();
    measured.push_back(error);
  }
  problem.AddBlock(trial, measured, {0},
                   [](const Vector& p, Eigen::Ref<Vector> values, Matrix* derivatives) -> Status {
                     values.setConstant(p[0]);
                     if (derivatives != nullptr) derivatives->col(0).setOnes();
                     return {};
                   });
}

double LagOne(const Vector& x) {
  const Eigen::Index n = x.size() - 1;
  return x.head(n).dot(x.tail(n)) / x.squaredNorm();
}

TEST(ResidualWhitening, LeavesWhiteResidualsOfUnitVariance) {
  FunctionProblem problem;
  problem.Add("level", -1, 1, 0);
  AddSlowError(problem, "first", 0.3, 1);
  AddSlowError(problem, "second", 0.3, 2);
  Fit fit(problem);
  auto workspace = fit.least_squares.NewWorkspace();
  Vector residuals;
  const Vector start = fit.least_squares.Start();
  ASSERT_TRUE(fit.least_squares.Evaluate(start, workspace, residuals, nullptr));
  EXPECT_GT(LagOne(residuals), 0.9);
  const auto whitening = solvers::ResidualWhitening(fit.least_squares, fit.least_squares.Parameters(start));
  ASSERT_NE(whitening, nullptr);
  fit.least_squares.set_transform(whitening.get());
  ASSERT_TRUE(fit.least_squares.Evaluate(start, workspace, residuals, nullptr));
  EXPECT_NEAR(LagOne(residuals), 0, 0.05);
  EXPECT_NEAR(residuals.squaredNorm() / static_cast<double>(residuals.size()), 1, 0.01);
}

TEST(ResidualWhitening, OfAnExactFitThereIsNone) {
  FunctionProblem problem;
  problem.Add("level", -1, 1, 0);
  AddSlowError(problem, "exact", 0, 1);
  const Fit fit(problem);
  EXPECT_EQ(solvers::ResidualWhitening(fit.least_squares, Vector::Zero(1)), nullptr);
}

}  // namespace
}  // namespace sinew
