#include "base/linear_curve.h"

#include <gtest/gtest.h>

namespace sinew {
namespace {

const std::vector<double> kKnots{-1, 0, 2};

TEST(LinearCurve, IsLinearBetweenKnotsAndConstantBeyond) {
  const double weights[] = {3, 5, 1};
  for (const auto& [x, expected] : {std::pair{-4.0, 3.0}, {-1.0, 3.0}, {-0.25, 4.5}, {0.5, 4.0}, {7.0, 1.0}})
    EXPECT_DOUBLE_EQ(LinearCurveAt(kKnots, weights, x), expected) << x;
}

TEST(LinearCurve, DerivativesForWeightsAndArgument) {
  using Number = Dual<4>;
  const Number weights[] = {Number::Variable(3, 0), Number::Variable(5, 1), Number::Variable(1, 2)};
  const Number within = LinearCurveAt(kKnots, weights, Number::Variable(0.5, 3));
  EXPECT_DOUBLE_EQ(within.value, 4);
  EXPECT_DOUBLE_EQ(within.d[0], 0);
  EXPECT_DOUBLE_EQ(within.d[1], 0.75);
  EXPECT_DOUBLE_EQ(within.d[2], 0.25);
  EXPECT_DOUBLE_EQ(within.d[3], -2);
  const Number beyond = LinearCurveAt(kKnots, weights, Number::Variable(3, 3));
  EXPECT_DOUBLE_EQ(beyond.d[2], 1);
  EXPECT_DOUBLE_EQ(beyond.d[3], 0);
  EXPECT_DOUBLE_EQ(LinearCurveAt(kKnots, weights, 0.5).d[1], 0.75);
}

}  // namespace
}  // namespace sinew
