#include "identify/solvers/levenberg_marquardt.h"

#include <gtest/gtest.h>

#include "tests/identify/support/function_problem.h"

namespace sinew {
namespace {

constexpr double kFall = 0.5;  // where the residual falls

// A residual that falls slowly, and beyond kFall all at once: no slope there tells of it.
class FallingResidual : public FunctionProblem {
 public:
  FallingResidual() {
    Add("x", 0, 1, 0.3);
    AddBlock("t", {0}, {0}, [](const Vector& p, Eigen::Ref<Vector> values, Matrix* derivatives) -> Status {
      const double u = p[0] - 0.4;
      values[0] = (p[0] < kFall ? 1.0 : 0.05) + 0.2 * u * u;
      if (derivatives != nullptr) (*derivatives)(0, 0) = 0.4 * u;
      return {};
    });
  }
};

double EndOf(bool within_basin) {
  const FallingResidual problem;
  const Fit fit(problem);
  Evaluator evaluator(fit.least_squares, {});
  const solvers::LevenbergMarquardt solver(1e-10, 1e-8, within_basin);
  return solver.Solve(evaluator, fit.least_squares.Start()).x[0];
}

TEST(LevenbergMarquardt, GoesWhereTheCostIsLower) {
  EXPECT_GT(EndOf(false), kFall);
}

TEST(LevenbergMarquardt, WithinABasinAStepThatGainsFarMoreThanPredictedIsNotTaken) {
  EXPECT_NEAR(EndOf(true), 0.4, 0.05);
}

}  // namespace
}  // namespace sinew
