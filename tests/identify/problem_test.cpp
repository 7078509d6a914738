#include "identify/problem.h"

#include <gtest/gtest.h>

#include "tests/identify/support/toy_problem.h"

namespace sinew {
namespace {

double Value(const std::vector<double>& knots, const Vector& weights, double x) {
  const LinearBasis basis = LinearBasisAt(knots, x);
  return basis.left * weights[basis.first] + (basis.right == 0 ? 0 : basis.right * weights[basis.first + 1]);
}

TEST(LinearBasis, InterpolatesBetweenKnotsAndIsConstantBeyond) {
  const std::vector<double> knots{-1, 0, 2};
  const Vector weights = toy::Values({3, 5, -1});
  EXPECT_EQ(Value(knots, weights, -7), 3);
  EXPECT_EQ(Value(knots, weights, -1), 3);
  EXPECT_EQ(Value(knots, weights, -0.5), 4);
  EXPECT_EQ(Value(knots, weights, 0), 5);
  EXPECT_EQ(Value(knots, weights, 1), 2);
  EXPECT_EQ(Value(knots, weights, 2), -1);
  EXPECT_EQ(Value(knots, weights, 9), -1);
  EXPECT_EQ(LinearBasisAt(knots, 1).left_slope, -0.5);
  EXPECT_EQ(LinearBasisAt(knots, 3).left_slope, 0);
}

TEST(Problem, HasNoOptionalPartsByDefault) {
  const toy::ToyProblem problem({toy::MakeParameter("a", 0, 1, 0.25)}, {}, {});
  EXPECT_TRUE(problem.effects().empty());
  EXPECT_TRUE(problem.ports().empty());
  EXPECT_TRUE(problem.constraints().empty());
  Hdf5Node details;
  EXPECT_TRUE(problem.WriteDetails(RestPoint(problem), details));
  EXPECT_TRUE(details.children.empty());
}

TEST(Problem, RestPointHoldsStartsAndNulls) {
  Parameter effect = toy::MakeParameter("drag", 0, 1, 0.5, ParameterKind::kEffect);
  effect.null_value = 0.125;
  const toy::ToyProblem problem({toy::MakeParameter("a", 0, 1, 0.25), effect,
                                 toy::MakeParameter("initial", -1, 1, -0.5, ParameterKind::kNuisance)},
                                {}, {});
  EXPECT_EQ(RestPoint(problem), toy::Values({0.25, 0.125, -0.5}));
}

}  // namespace
}  // namespace sinew
