// Minima compared by what lies under them, against densities that are known.
#include "identify/solvers/marginal_cost.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/identify/support/classic_problems.h"

namespace sinew {
namespace {

constexpr double kMeasured = 3;
constexpr double kDeviation = 0.5;

// y = scale * b + noise, b standard normal: y is normal with variance scale^2 + noise^2.
void MakeScaledNormal(FunctionProblem& problem, double scale) {
  problem.Add("scale", 0.01, 100, scale);
  Parameter b;
  b.name = "b";
  b.unit = "1";
  b.lower = -50;
  b.upper = 50;
  b.start = scale * kMeasured / (scale * scale + kDeviation * kDeviation);  // the most probable one
  b.kind = ParameterKind::kNuisance;
  b.trial = "t";
  b.prior = GaussianPrior{0, 1};
  problem.Add(std::move(b));
  problem.AddBlock("t", {kMeasured / kDeviation}, {0, 1},
                   [](const Vector& p, Eigen::Ref<Vector> predicted, Matrix* derivatives) -> Status {
                     predicted[0] = p[0] * p[1] / kDeviation;
                     if (derivatives != nullptr) derivatives->row(0) << p[1] / kDeviation, p[0] / kDeviation;
                     return {};
                   });
}

double Marginal(double scale) {
  FunctionProblem problem;
  MakeScaledNormal(problem, scale);
  const Fit fit(problem);
  return solvers::MarginalCost(fit.least_squares, fit.least_squares.Start());
}

TEST(MarginalCost, OfALinearModelIsItsDensity) {
  const auto exact = [](double scale) {
    const double variance = scale * scale + kDeviation * kDeviation;
    return 0.5 * kMeasured * kMeasured / variance + 0.5 * std::log(variance);
  };
  for (const double scale : {0.1, 0.5, 3.0, 40.0})
    EXPECT_NEAR(Marginal(scale) - Marginal(1), exact(scale) - exact(1), 1e-9) << scale;
}

TEST(MarginalCost, ANarrowPeakIsWorthLessThanItsHeight) {
  // With a large scale b need hardly move, so that the cost is next to nothing; but hardly any b fits.
  EXPECT_GT(Marginal(40), Marginal(3) + 1);
}

TEST(MarginalCost, IsTheCostWithoutNuisanceValues) {
  FunctionProblem problem;
  Judge::MakeProblem(problem);
  const Fit fit(problem);
  auto workspace = fit.least_squares.NewWorkspace();
  const Vector x = fit.least_squares.Start();
  EXPECT_EQ(solvers::MarginalCost(fit.least_squares, x), *fit.least_squares.Cost(x, workspace));
}

// From one setup, the MarginalCost that the model there predicts for its minimum, where that is known.
TEST(PredictMinimum, OfALinearModelIsThatOfItsMinimum) {
  FunctionProblem problem;
  MakeScaledNormal(problem, 3);
  FitRequest request;
  request.fix.emplace_back("scale", 3);
  FitSetup setup = MakeFitSetup(problem, request).value();
  const LeastSquares fit(problem, setup);
  const double expected = solvers::MarginalCost(fit, fit.Start());  // starts at the minimum
  for (const double b : {0.0, 20.0, 3000.0}) {                      // the last one beyond the bounds
    setup.rest[1] = b;
    EXPECT_NEAR(solvers::PredictMinimum(problem, setup).marginal, expected, 1e-7 * (1 + b)) << b;
  }
}

TEST(PredictMinimum, LooksForTheMinimumWithinTheBoundsOfWhatHasNoPrior) {
  FunctionProblem problem;
  problem.Add("a", 0, 1, 0.5);
  problem.AddBlock("t", {3}, {0},
                   [](const Vector& p, Eigen::Ref<Vector> predicted, Matrix* derivatives) -> Status {
                     predicted[0] = p[0];
                     if (derivatives != nullptr) derivatives->setConstant(1);
                     return {};
                   });
  EXPECT_NEAR(solvers::PredictMinimum(problem, MakeFitSetup(problem, {}).value()).marginal, 0.5 * 2 * 2,
              1e-12);
}

}  // namespace
}  // namespace sinew
