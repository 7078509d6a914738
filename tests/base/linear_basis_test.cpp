#include "base/linear_basis.h"

#include <gtest/gtest.h>

namespace sinew {
namespace {

double Value(const std::vector<double>& knots, const std::vector<double>& weights, double x) {
  const LinearBasis basis = LinearBasisAt(knots, x);
  const auto first = static_cast<std::size_t>(basis.first);
  return basis.left * weights[first] + (basis.right == 0 ? 0 : basis.right * weights[first + 1]);
}

TEST(LinearBasis, InterpolatesBetweenKnotsAndIsConstantBeyond) {
  const std::vector<double> knots{-1, 0, 2};
  const std::vector<double> weights{3, 5, -1};
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

}  // namespace
}  // namespace sinew
