#include "identify/range.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "identify/identification/identification.h"
#include "tests/identify/support/toy_problem.h"

namespace sinew {
namespace {

using toy::MakeBlock;
using toy::MakeParameter;
using toy::ToyProblem;
using toy::Values;

using Measure = std::function<double(const Range&, const Vector&, Vector*)>;

void ExpectSlopesAgree(const Measure& measure, const Range& range, const Vector& values) {
  constexpr double kStep = 1e-6;
  Vector slopes;
  measure(range, values, &slopes);
  ASSERT_EQ(slopes.size(), values.size());
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    Vector above = values;
    Vector below = values;
    above[i] += kStep;
    below[i] -= kStep;
    EXPECT_NEAR(slopes[i], (measure(range, above, nullptr) - measure(range, below, nullptr)) / (2 * kStep),
                1e-5)
        << i;
  }
}

TEST(Range, DistanceIsZeroWithinAndTheNormOfWhatIsOutside) {
  const Range range{0.5, 1.5};
  Vector slopes;
  EXPECT_EQ(DistanceFrom(range, Values({0.5, 1, 1.5}), &slopes), 0);
  EXPECT_EQ(slopes, Values({0, 0, 0}));
  EXPECT_DOUBLE_EQ(DistanceFrom(range, Values({0.2, 1, 1.9}), nullptr), 0.5);
  ExpectSlopesAgree(DistanceFrom, range, Values({0.2, 1, 1.9, 0.45}));
}

TEST(Range, FarthestIsBoundedFromAboveByAHundredthOfTheWidth) {
  const Range range{0.5, 1.5};
  for (const auto& [values, farthest] : {std::pair{Values({0.7, 1, 1.4}), -0.1},
                                         {Values({0.6, 1, 1.4, 0.6}), -0.1},
                                         {Values({2, 2, 2}), 0.5},
                                         {Values({0.2, 1.6}), 0.3},
                                         {Values({1}), -0.5}}) {
    const double bound = FarthestFrom(range, values, nullptr);
    EXPECT_GE(bound, farthest);
    EXPECT_LE(bound, farthest + 0.01);
  }
  ExpectSlopesAgree(FarthestFrom, range, Values({1.49, 1.495, 0.505, 1}));
}

// y = a is measured at 3; z = 2 a is not measured and should stay below 4.
ToyProblem Pulled(bool strict, double tolerance) {
  Block z = MakeBlock("t", "z", 4, 1);
  z.role = BlockRole::kPredicted;
  z.sample.clear();
  z.measured.clear();
  z.range = Range{0, 4, strict};
  z.weight = 1 / tolerance;
  ToyProblem problem({MakeParameter("a", 0, 10, 1)}, {MakeBlock("t", "y", 25, 1), z},
                     [](const Block& block, double, const Vector& p, Vector* gradient) -> Result<double> {
                       const double factor = block.channel == "z" ? 2 : 1;
                       if (gradient != nullptr) *gradient << factor;
                       return factor * p[0];
                     });
  problem.Measure(Values({3}), [](const Block&, int i) { return 0.01 * (i % 2); });
  return problem;
}

Identification Fit(const ToyProblem& problem, const std::string& solver) {
  IdentificationOptions options;
  options.solver = solver;
  const auto fit = Identify(problem, MakeFitSetup(problem, {}).value(), options);
  EXPECT_TRUE(fit) << fit.error().message;
  return fit.value_or(Identification{});
}

// 25 (a - 3.0048)^2 + 4 (2 a - 4)^2 / tolerance^2 is least at the weighted mean.
TEST(Range, AResidualPullsTheFitTowardsIt) {
  constexpr double kMeasured = 3.0048;  // mean of 3 and 12 of 25 times 0.01 more
  for (const double tolerance : {0.5, 2.0}) {
    const double pull = 16 / (tolerance * tolerance);
    const double expected = (25 * kMeasured + pull * 2) / (25 + pull);
    for (const char* solver : {"ceres", "lm", "ipopt"})
      EXPECT_NEAR(Fit(Pulled(false, tolerance), solver).parameters[0], expected, 1e-5) << solver;
  }
}

TEST(Range, TheResidualIsZeroWithin) {
  const ToyProblem problem = Pulled(false, 0.5);
  const FitSetup setup = MakeFitSetup(problem, {}).value();
  const LeastSquares fit(problem, setup);
  auto workspace = fit.NewWorkspace();
  auto jacobian = fit.NewJacobian();
  Vector residuals;
  ASSERT_TRUE(fit.Evaluate(Values({0.1}), workspace, residuals, &jacobian));
  ASSERT_EQ(residuals.size(), 26);
  EXPECT_EQ(residuals[25], 0);
  EXPECT_EQ(jacobian.pieces.back().values(0, 0), 0);
  ASSERT_TRUE(fit.Evaluate(Values({0.3}), workspace, residuals, &jacobian));
  EXPECT_DOUBLE_EQ(residuals[25], 2 * 2 * 2);  // weight 2, four values 2 above
  EXPECT_DOUBLE_EQ(jacobian.pieces.back().values(0, 0),
                   2 * 4 * 0.5 * 2 * 10);  // weight, values, slope of each, dz/da, range of a
}

TEST(Range, AStrictOneIsAConstraint) {
  const ToyProblem problem = Pulled(true, 1);
  for (const char* solver : {"ipopt", "nlopt:LD_SLSQP"}) {
    const Identification fit = Fit(problem, solver);
    ASSERT_EQ(fit.parameters.size(), 1) << solver << fit.result.stop.test;
    EXPECT_LE(fit.parameters[0], 2 + 1e-8) << solver;
    EXPECT_GE(fit.parameters[0], 1.98) << solver;
    const auto is = [](const Warning& w) {
      return w.kind == WarningKind::kActiveConstraint &&
             w.names == std::vector<std::string>{"z within 0 .. 4 in trial t"};
    };
    EXPECT_TRUE(std::any_of(fit.warnings.begin(), fit.warnings.end(), is)) << solver;
  }
}

}  // namespace
}  // namespace sinew
