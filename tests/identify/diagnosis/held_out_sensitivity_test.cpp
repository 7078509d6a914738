// The predictive density of held-out residuals against its definition.
#include "identify/diagnosis/held_out_sensitivity.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace sinew::diagnosis {
namespace {

TEST(PredictiveDeviance, IsThatOfTheNormalDensity) {
  Random random(3);
  Matrix changes(7, 3);
  Vector residual(7);
  for (double& value : changes.reshaped()) value = 2 * random.Normal();
  for (double& value : residual) value = random.Normal();
  const Matrix covariance = Matrix::Identity(7, 7) + changes * changes.transpose();
  const double expected = residual.dot(covariance.inverse() * residual) + std::log(covariance.determinant());
  EXPECT_NEAR(PredictiveDeviance(residual, changes), expected, 1e-9);
}

TEST(PredictiveDeviance, WithoutErrorsIsTheSumOfSquares) {
  Vector residual(2);
  residual << 3, 4;
  EXPECT_EQ(PredictiveDeviance(residual, Matrix(2, 0)), 25);
}

}  // namespace
}  // namespace sinew::diagnosis
