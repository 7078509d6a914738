#include "identify/solvers/alternating_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/constants.h"
#include "base/random.h"
#include "tests/identify/support/function_problem.h"

namespace sinew {
namespace {

constexpr double kCycles = 13.7;
constexpr double kDrift = 8;
constexpr int kPoints = 400;
enum : int { kCosine, kSine, kRate };

// A sine of unknown amplitude and rate beside a large drift that the model lacks.
void AddDriftingSine(FunctionProblem& problem, double first_rate) {
  problem.Add("cosine", -5, 5, 0.1).Add("sine", -5, 5, 0.1).Add("rate", 1, 30, first_rate);
  Random random(1);
  std::vector<double> measured;
  for (int i = 0; i < kPoints; ++i) {
    const double t = static_cast<double>(i) / kPoints;
    const double angle = 2 * kPi * kCycles * t;
    measured.push_back(0.3 * std::cos(angle) - 0.2 * std::sin(angle) + kDrift * (std::exp(-3 * t) - 0.3) +
                       1e-3 * random.Normal());
  }
  problem.AddBlock("trial", measured, {kCosine, kSine, kRate},
                   [](const Vector& p, Eigen::Ref<Vector> values, Matrix* derivatives) -> Status {
                     for (int i = 0; i < kPoints; ++i) {
                       const double t = static_cast<double>(i) / kPoints;
                       const double c = std::cos(2 * kPi * p[kRate] * t);
                       const double s = std::sin(2 * kPi * p[kRate] * t);
                       values[i] = p[kCosine] * c + p[kSine] * s;
                       if (derivatives == nullptr) continue;
                       (*derivatives)(i, kCosine) = c;
                       (*derivatives)(i, kSine) = s;
                       (*derivatives)(i, kRate) = 2 * kPi * t * (p[kSine] * c - p[kCosine] * s);
                     }
                     return {};
                   });
}

solvers::LocalFit::Outcome Alone(const Fit& fit) {
  return solvers::LocalFit(fit.least_squares).Minimize(fit.least_squares.Start(), -1, {0, 1e-9}, 200);
}

solvers::LocalFit::Outcome Alternately(Fit& fit, bool stopped = false) {
  return solvers::AlternatingFit(fit.least_squares, fit.least_squares.Start(), {0, 1e-9},
                                 [=] { return stopped; });
}

TEST(AlternatingFit, LeavesAMinimumThatADriftMakes) {
  FunctionProblem problem;
  AddDriftingSine(problem, 13);
  Fit fit(problem);
  const auto alone = Alone(fit);
  EXPECT_LT(fit.least_squares.Parameters(alone.x)[kRate], 13.2) << "the search alone should miss it";
  const auto found = Alternately(fit);
  EXPECT_TRUE(found.failure.empty());
  EXPECT_LT(found.cost, 0.99 * alone.cost);
  EXPECT_NEAR(fit.least_squares.Parameters(found.x)[kRate], kCycles, 0.4);
  auto workspace = fit.least_squares.NewWorkspace();
  EXPECT_NEAR(*fit.least_squares.Cost(found.x, workspace), found.cost, 1e-9 * found.cost)
      << "the cost is the plain one, and no transform is left behind";
}

TEST(AlternatingFit, EndsWhereTheLocalFitDoesIfWhiteningDoesNotHelpOrWhenStopped) {
  FunctionProblem near;
  AddDriftingSine(near, 14);
  Fit fit(near);
  const auto alone = Alone(fit);
  EXPECT_EQ(Alternately(fit).x, alone.x);
  FunctionProblem far;
  AddDriftingSine(far, 13);
  Fit stopped(far);
  EXPECT_LT(stopped.least_squares.Parameters(Alternately(stopped, true).x)[kRate], 13.2);
}

}  // namespace
}  // namespace sinew
