#include "base/local_polynomial.h"

#include <gmock/gmock.h>

#include <cmath>

namespace sinew {
namespace {

using testing::DoubleNear;
using testing::Pointwise;

double SumOf(const std::vector<double>& a, const std::vector<double>& y) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * y[k];
  return sum;
}

// Savitzky, Golay 1964, table I: a parabola through five, seven samples.
TEST(LocalPolynomial, CoefficientsOfSavitzkyAndGolay) {
  const std::vector<double> of_five{-3 / 35.0, 12 / 35.0, 17 / 35.0, 12 / 35.0, -3 / 35.0};
  EXPECT_THAT(LocalPolynomial({-2, -1, 0, 1, 2}, std::vector<double>(5, 1), 2),
              Pointwise(DoubleNear(1e-14), of_five));
  const std::vector<double> of_seven{-2 / 21.0, 3 / 21.0, 6 / 21.0, 7 / 21.0, 6 / 21.0, 3 / 21.0, -2 / 21.0};
  EXPECT_THAT(LocalPolynomial({-3e-3, -2e-3, -1e-3, 0, 1e-3, 2e-3, 3e-3}, std::vector<double>(7, 4), 2),
              Pointwise(DoubleNear(1e-14), of_seven));
}

TEST(LocalPolynomial, APolynomialOfItsDegreeIsReadExactlyAtUnevenPlaces) {
  const std::vector<double> x{-0.3, -0.21, 0.04, 0.1, 0.55};
  const std::vector<double> weights{1, 0.2, 3, 0, 0.5};
  for (const int degree : {0, 1, 2, 3}) {
    std::vector<double> y;
    for (const double place : x) y.push_back(2 - std::pow(place, degree) + (degree > 1 ? 5 * place : 0));
    EXPECT_NEAR(SumOf(LocalPolynomial(x, weights, degree), y), degree == 0 ? 1 : 2, 1e-12) << degree;
  }
  EXPECT_EQ(LocalPolynomial(x, weights, 2)[3], 0) << "no weight";
}

TEST(LocalPolynomial, TooFewSamplesDetermineNone) {
  EXPECT_TRUE(LocalPolynomial({}, {}, 0).empty());
  EXPECT_TRUE(LocalPolynomial({1, 2}, {0, 0}, 0).empty());
  EXPECT_TRUE(LocalPolynomial({1, 2, 2}, {1, 1, 1}, 2).empty());
  EXPECT_TRUE(LocalPolynomial({1, 2, 3}, {1, 1, 0}, 2).empty());
  EXPECT_FALSE(LocalPolynomial({1, 2, 3}, {1, 1, 0}, 1).empty());
}

TEST(LocalPolynomial, TheResidualIsWhatThePolynomialLeaves) {
  const double nan = std::nan("");
  const std::vector<double> x{-1, 0, 1, 5};
  const std::vector<double> weights{2, 2, 2, 0};
  EXPECT_NEAR(LocalPolynomialResidual(x, {3, 1, 3, nan}, weights, 2), 0, 1e-24);
  EXPECT_NEAR(LocalPolynomialResidual(x, {-1, 0, 1, nan}, weights, 0), 4, 1e-12);
  EXPECT_NEAR(LocalPolynomialResidual(x, {0, 3, 0, nan}, weights, 1), 2 * (1 + 4 + 1), 1e-12);
  EXPECT_TRUE(std::isnan(LocalPolynomialResidual(x, {0, 3, 0, nan}, weights, 3)));
}

}  // namespace
}  // namespace sinew
