#include "identify/least_squares.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "base/random.h"
#include "tests/identify/support/error_of.h"
#include "tests/identify/support/function_problem.h"
#include "tests/identify/support/toy_problem.h"

namespace sinew {
namespace {

using toy::MakeBlock;
using toy::MakeParameter;
using toy::ToyFit;
using toy::ToyProblem;
using toy::Values;

Parameter LogParameter(const std::string& name, double lower, double upper, double start) {
  Parameter p = MakeParameter(name, lower, upper, start);
  p.scale = Scale::kLog;
  return p;
}

// y = a exp(-b t): a on a linear scale, b on a logarithmic one.
Result<double> DecayAt(const Block& /*block*/, double t, const Vector& p, Vector* gradient) {
  const double e = std::exp(-p[1] * t);
  if (gradient != nullptr) *gradient << e, -p[0] * t * e;
  return p[0] * e;
}

ToyProblem DecayProblem(Layout layout) {
  return ToyProblem({MakeParameter("a", -2, 6, 1), LogParameter("b", 0.01, 100, 1)}, std::move(layout),
                    DecayAt);
}

TEST(LeastSquaresVariables, LogScaleMapsEqualRatiosToEqualSteps) {
  constexpr double kRounding = 1e-14;  // exp and log
  const ToyProblem problem = DecayProblem({MakeBlock("t", "y", 3, 1)});
  const ToyFit fit(problem);
  EXPECT_NEAR(fit.view.Parameters(Values({0.5, 0.5}))[0], 2, kRounding);
  EXPECT_NEAR(fit.view.Parameters(Values({0.5, 0.25}))[1], 0.1, kRounding);
  EXPECT_NEAR(fit.view.Parameters(Values({0.5, 0.5}))[1], 1, kRounding);
  EXPECT_NEAR(fit.view.Parameters(Values({0.5, 0.75}))[1], 10, 10 * kRounding);
  EXPECT_NEAR(fit.view.Start()[0], 3.0 / 8, kRounding);
  EXPECT_NEAR(fit.view.Start()[1], 0.5, kRounding);
}

TEST(LeastSquaresVariables, BoundsAreExactAtZeroAndOneAndClampedBeyond) {
  const ToyProblem problem({MakeParameter("a", -0.1, 0.3, 0), LogParameter("b", 0.017, 1234.5, 1),
                            LogParameter("c", 1e4, 1e9, 1e6)},
                           {MakeBlock("t", "y", 2, 1)}, DecayAt);
  const ToyFit fit(problem);
  const Vector lower = Values({-0.1, 0.017, 1e4});
  const Vector upper = Values({0.3, 1234.5, 1e9});
  EXPECT_EQ(fit.view.Parameters(Vector::Zero(3)), lower);
  EXPECT_EQ(fit.view.Parameters(Vector::Ones(3)), upper);
  EXPECT_EQ(fit.view.Parameters(Vector::Constant(3, -0.5)), lower);
  EXPECT_EQ(fit.view.Parameters(Vector::Constant(3, 1.5)), upper);
  EXPECT_EQ(fit.view.Variables(lower), Vector::Zero(3));
  EXPECT_EQ(fit.view.Variables(upper), Vector::Ones(3));
}

// The parameters of a Query are within bounds, also where rounding next to a bound would put them beyond it.
TEST(LeastSquaresVariables, NoPointOfTheBoxLeavesTheBounds) {
  Random random(1);
  const double near_one = std::nextafter(1.0, 0.0);
  for (int round = 0; round < 2000; ++round) {
    const double lower = std::exp(random.Uniform(-20, 20));
    const double upper = lower + lower * random.Uniform(0.01, 3);
    const double offset = random.Uniform(-1, 1);
    const ToyProblem problem({LogParameter("a", lower, upper, lower),
                              MakeParameter("b", offset, offset + random.Uniform(0.01, 1), offset)},
                             {}, DecayAt);
    const ToyFit fit(problem);
    for (const double x :
         {std::numeric_limits<double>::min(), 1e-17, random.Uniform(), 1 - 1e-15, near_one}) {
      const Vector p = fit.view.Parameters(Vector::Constant(2, x));
      for (int i = 0; i < 2; ++i) {
        const Parameter& parameter = problem.parameters()[static_cast<std::size_t>(i)];
        ASSERT_GE(p[i], parameter.lower) << "x = " << x;
        ASSERT_LE(p[i], parameter.upper) << "x = " << x;
      }
    }
  }
}

TEST(LeastSquaresVariables, VariablesAndParametersAreInverse) {
  constexpr double kRounding = 1e-13;  // the logarithmic scale spans four decades
  const ToyProblem problem = DecayProblem({MakeBlock("t", "y", 3, 1)});
  const ToyFit fit(problem);
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    const Vector x = Values({random.Uniform(), random.Uniform()});
    EXPECT_LT((fit.view.Variables(fit.view.Parameters(x)) - x).norm(), kRounding);
  }
}

TEST(LeastSquaresVariables, FixedParametersKeepTheirValue) {
  const ToyProblem problem = DecayProblem({MakeBlock("t", "y", 3, 1)});
  FitRequest request;
  request.fix = {{"a", 4}};
  const Fit fit(problem, request);
  ASSERT_EQ(fit.least_squares.variables(), 1);
  EXPECT_EQ(fit.least_squares.Parameters(Values({1})), Values({4, 100}));
}

TEST(LeastSquares, ResidualIsWeightTimesPredictedMinusMeasuredAtTheSamples) {
  Block block = MakeBlock("t", "y", 4, 3);  // at 0, 1, 2, 3 s
  block.sample = {0, 2, 3};                 // a gap at 1 s
  block.measured = {1, 2, 3};
  block.weight = 0.5;
  const ToyProblem problem({MakeParameter("a", -10, 10, 0), MakeParameter("b", -10, 10, 0)}, {block},
                           [](const Block&, double t, const Vector& p, Vector* gradient) -> Result<double> {
                             if (gradient != nullptr) *gradient << 1, t;
                             return p[0] + p[1] * t;
                           });
  const ToyFit fit(problem);
  auto workspace = fit.view.NewWorkspace();
  Vector residuals;
  ASSERT_TRUE(fit.view.Evaluate(fit.view.Variables(Values({5, 2})), workspace, residuals, nullptr));
  EXPECT_EQ(residuals, Values({0.5 * (5 - 1), 0.5 * (9 - 2), 0.5 * (11 - 3)}));
  EXPECT_EQ(fit.view.Cost(fit.view.Variables(Values({5, 2})), workspace).value(),
            0.5 * (2 * 2 + 3.5 * 3.5 + 4 * 4));
}

TEST(LeastSquares, SamplesMayHaveWeightsOfTheirOwn) {
  Block block = MakeBlock("t", "y", 3, 1);
  block.measured = {1, 2, 3};
  block.weight = 2;
  block.relative_weight = {1, 0.5, 4};
  const ToyProblem problem({MakeParameter("a", -10, 10, 0)}, {block},
                           [](const Block&, double, const Vector& p, Vector* gradient) -> Result<double> {
                             if (gradient != nullptr) *gradient << 1;
                             return p[0];
                           });
  const ToyFit fit(problem);
  auto workspace = fit.view.NewWorkspace();
  auto jacobian = fit.view.NewJacobian();
  Vector residuals;
  ASSERT_TRUE(fit.view.Evaluate(fit.view.Variables(Values({5})), workspace, residuals, &jacobian));
  EXPECT_EQ(residuals, Values({2 * 4, 1 * 3, 8 * 2}));
  EXPECT_EQ(Vector(jacobian.Dense(3, 1).col(0)), Values({2 * 20, 1 * 20, 8 * 20})) << "the range is 20";
}

TEST(LeastSquares, OnlyTrainingBlocksAreInTheCost) {
  const ToyProblem problem =
      DecayProblem({MakeBlock("v", "y", 5, 1, BlockRole::kValidate), MakeBlock("t", "y", 3, 1),
                    MakeBlock("t", "z", 7, 1, BlockRole::kPredicted), MakeBlock("u", "y", 2, 1)});
  const ToyFit fit(problem);
  EXPECT_EQ(fit.view.residuals(), 5);
  ASSERT_EQ(fit.view.train_blocks().size(), 2U);
  EXPECT_EQ(fit.view.train_blocks()[0].block, 1);
  EXPECT_EQ(fit.view.train_blocks()[0].first_row, 0);
  EXPECT_EQ(fit.view.train_blocks()[1].block, 3);
  EXPECT_EQ(fit.view.train_blocks()[1].first_row, 3);
}

TEST(LeastSquares, JacobianAgreesWithDifferences) {
  constexpr double kStep = 6e-6;  // cbrt(eps)
  constexpr double kTolerance =
      1e-7;  // eps^(2/3) = 4e-11 times the third derivative: log(1e4)^3 = 780 of the scale
  Parameter a = MakeParameter("a", -2, 6, 1);
  a.prior = GaussianPrior{0.5, 0.25};
  Parameter b = LogParameter("b", 0.01, 100, 1);
  b.prior = GaussianPrior{std::log(2.0), 0.5};
  Block gappy = MakeBlock("u", "y", 6, 2);
  gappy.sample = {1, 2, 5};
  gappy.measured = {0.1, 0.2, 0.3};
  gappy.weight = 3;
  gappy.relative_weight = {0.5, 2, 1.5};
  const ToyProblem problem({a, b}, {MakeBlock("t", "y", 9, 1), gappy}, DecayAt);
  const ToyFit fit(problem);
  ASSERT_EQ(fit.view.residuals(), 9 + 3 + 2);

  auto workspace = fit.view.NewWorkspace();
  auto jacobian = fit.view.NewJacobian();
  Random random(3);
  for (int round = 0; round < 20; ++round) {
    const Vector x = Values({random.Uniform(0.1, 0.9), random.Uniform(0.1, 0.7)});
    Vector residuals;
    ASSERT_TRUE(fit.view.Evaluate(x, workspace, residuals, &jacobian));
    const Matrix dense = jacobian.Dense(fit.view.residuals(), 2);
    for (int k = 0; k < 2; ++k) {
      Vector right;
      Vector left;
      ASSERT_TRUE(fit.view.Evaluate(x + kStep * Vector::Unit(2, k), workspace, right, nullptr));
      ASSERT_TRUE(fit.view.Evaluate(x - kStep * Vector::Unit(2, k), workspace, left, nullptr));
      const Vector difference = (right - left) / (2 * kStep);
      EXPECT_LT((dense.col(k) - difference).norm(), kTolerance * (1 + difference.norm()));
    }
  }
}

TEST(LeastSquares, SlopesAreDerivativesOfTheParameters) {
  constexpr double kStep = 6e-6;  // cbrt(eps)
  constexpr double kTolerance =
      1e-8;  // relative; the third derivative of the logarithmic scale is log(1e4)^3
  const ToyProblem problem = DecayProblem({MakeBlock("t", "y", 3, 1)});
  const ToyFit fit(problem);
  const Vector x = Values({0.3, 0.6});
  const Vector slopes = fit.view.Slopes(x);
  const Vector step = Vector::Constant(2, kStep);
  const Vector difference = (fit.view.Parameters(x + step) - fit.view.Parameters(x - step)) / (2 * kStep);
  EXPECT_LT((slopes - difference).norm(), kTolerance * slopes.norm());
}

TEST(LeastSquares, PiecesHoldOnlyTheVariablesOfTheirBlock) {
  FunctionProblem problem;
  problem.Add("slope", -1, 1, 0.5).Add("start_1", -1, 1, 0).Add("start_2", -1, 1, 0).Add("unused", -1, 1, 0);
  const auto line = [](Eigen::Index own) {
    return [own](const Vector& p, Eigen::Ref<Vector> values, Matrix* derivatives) -> Status {
      for (Eigen::Index i = 0; i < values.size(); ++i) {
        values[i] = p[own] + p[0] * static_cast<double>(i);
        if (derivatives != nullptr) (*derivatives)(i, 0) = static_cast<double>(i);
      }
      if (derivatives != nullptr) derivatives->col(own).setOnes();
      return {};
    };
  };
  problem.AddBlock("one", {0, 0, 0}, {0, 1}, line(1)).AddBlock("two", {0, 0}, {0, 2}, line(2));
  FitRequest request;
  request.fix = {{"slope", 0.5}};
  const Fit all(problem);
  const Fit fixed(problem, request);

  auto jacobian = all.least_squares.NewJacobian();
  auto workspace = all.least_squares.NewWorkspace();
  Vector residuals;
  ASSERT_TRUE(all.least_squares.Evaluate(all.least_squares.Start(), workspace, residuals, &jacobian));
  ASSERT_EQ(jacobian.pieces.size(), 2U);
  EXPECT_EQ(jacobian.pieces[0].variables, (std::vector<int>{0, 1}));
  EXPECT_EQ(jacobian.pieces[1].variables, (std::vector<int>{0, 2}));
  EXPECT_EQ(jacobian.pieces[1].first_row, 3);
  Matrix expected(5, 4);  // dp/dx is 2 for all
  expected << 0, 2, 0, 0, 2, 2, 0, 0, 4, 2, 0, 0, 0, 0, 2, 0, 2, 0, 2, 0;
  EXPECT_EQ(jacobian.Dense(5, 4), expected);

  const auto without_slope = fixed.least_squares.NewJacobian();
  EXPECT_EQ(without_slope.pieces[0].variables, (std::vector<int>{0}));
  EXPECT_EQ(without_slope.pieces[1].variables, (std::vector<int>{1}));
}

TEST(LeastSquares, PriorsAreResidualsInTheScaleOfTheirParameter) {
  constexpr double kRounding = 1e-14;
  Parameter a = MakeParameter("a", -2, 6, 1);
  a.prior = GaussianPrior{3, 0.5};
  Parameter b = LogParameter("b", 0.01, 100, 1);
  b.prior = GaussianPrior{std::log(10.0), 2};
  const ToyProblem problem({a, b}, {MakeBlock("t", "y", 2, 1)}, DecayAt);
  const ToyFit fit(problem);
  auto workspace = fit.view.NewWorkspace();
  Vector residuals;
  ASSERT_TRUE(fit.view.Evaluate(fit.view.Variables(Values({4, 0.1})), workspace, residuals, nullptr));
  ASSERT_EQ(residuals.size(), 4);
  EXPECT_NEAR(residuals[2], (4 - 3) / 0.5, kRounding);
  EXPECT_NEAR(residuals[3], (std::log(0.1) - std::log(10.0)) / 2, kRounding);

  FitRequest request;
  request.fix = {{"a", 4}};
  EXPECT_EQ(Fit(problem, request).least_squares.residuals(), 3) << "the prior of a fixed value is a constant";
}

TEST(LeastSquares, FailuresArePassedOn) {
  const ToyProblem failing({MakeParameter("a", 0, 1, 0.5)}, {MakeBlock("t", "y", 2, 1)},
                           [](const Block&, double, const Vector&, Vector*) -> Result<double> {
                             return Fail("the integrator gave up at t = 0.2 s");
                           });
  const ToyProblem not_finite(
      {MakeParameter("a", 0, 1, 0.5)}, {MakeBlock("t", "y", 2, 1)},
      [](const Block&, double, const Vector& p, Vector*) -> Result<double> { return 1 / (p[0] - 0.5); });
  const ToyProblem throwing({MakeParameter("a", 0, 1, 0.5)}, {MakeBlock("t", "y", 2, 1)},
                            [](const Block&, double, const Vector&, Vector*) -> Result<double> {
                              throw std::runtime_error("no licence");
                            });
  for (const auto& [problem, message] :
       {std::pair{&failing, "the integrator gave up at t = 0.2 s"},
        std::pair{&not_finite, "a predicted value is not finite: block t/y, sample 0 (t = 0 s) is inf"},
        std::pair{&throwing, "the model threw: no licence"}}) {
    const ToyFit fit(*problem);
    auto workspace = fit.view.NewWorkspace();
    Vector residuals;
    EXPECT_EQ(ErrorOf(fit.view.Evaluate(Values({0.5}), workspace, residuals, nullptr)), message);
    EXPECT_EQ(ErrorOf(fit.view.Cost(Values({0.5}), workspace)), message);
  }
}

TEST(LeastSquares, ConstraintsAreExpressedInTheVariables) {
  constexpr double kRounding = 1e-13;
  // b <= a + 1 with a fixed.
  const ToyProblem problem({MakeParameter("a", -2, 6, 1), LogParameter("b", 0.01, 100, 1)},
                           {MakeBlock("t", "y", 2, 1)}, DecayAt, {{"b at most a + 1", Values({-1, 1}), -1}});
  FitRequest request;
  request.fix = {{"a", 2}};
  const Fit fit(problem, request);
  ASSERT_EQ(fit.least_squares.constraints(), 1);
  Vector values;
  Matrix jacobian;
  const Vector x = fit.least_squares.Variables(Values({2, 10}));
  auto workspace = fit.least_squares.NewWorkspace();
  ASSERT_TRUE(fit.least_squares.Constraints(x, workspace, values, &jacobian));
  EXPECT_NEAR(values[0], 7, 10 * kRounding);
  ASSERT_EQ(jacobian.cols(), 1);
  EXPECT_NEAR(jacobian(0, 0), 10 * std::log(1e4), 100 * kRounding);
}

TEST(LowerOf, IsThePointOfLowerCostAndTheFirstOneInDoubt) {
  FunctionProblem problem;
  problem.Add("a", -4, 4, 0);
  problem.AddBlock("trial", {0.0}, {0},
                   [](const Vector& p, Eigen::Ref<Vector> values, Matrix* derivatives) -> Status {
                     if (p[0] > 2) return Fail("no prediction");
                     values[0] = p[0];
                     if (derivatives != nullptr) (*derivatives)(0, 0) = 1;
                     return {};
                   });
  const Fit fit(problem);
  const auto lower = [&](double first, double second) {
    const LeastSquares& least = fit.least_squares;
    const auto at = [&](double a) { return least.Variables(Values({a})); };
    return least.Parameters(LowerOf(least, at(first), at(second)))[0];
  };
  EXPECT_NEAR(lower(1, 0.5), 0.5, 1e-12);
  EXPECT_NEAR(lower(0.5, 1), 0.5, 1e-12);
  EXPECT_NEAR(lower(1, -1), 1, 1e-12) << "equal";
  EXPECT_NEAR(lower(3, 1), 1, 1e-12) << "the first fails";
  EXPECT_NEAR(lower(1, 3), 1, 1e-12) << "the second fails";
  EXPECT_NEAR(lower(3, 4), 3, 1e-12) << "both fail";
}

}  // namespace
}  // namespace sinew
