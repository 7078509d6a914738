#include "models/multibody/piecewise_polynomial.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace sinew {
namespace {

using testing::HasSubstr;

constexpr double kPolynomialRounding =
    1e-12;                            // values of order one through a well-conditioned tridiagonal system
constexpr double kDifference = 1e-7;  // central differences with h = 1e-5: h^2 f''' plus eps / h
constexpr double kStep = 1e-5;

const std::vector<double> kX{-2.1, -1.7, -1.4, -1.0, -0.7, -0.35, -0.17, 0.2, 0.34, 0.49, 1.5, 2.1};
const std::vector<double> kY{-0.32, 0.18, 0.41, 0.41, 0.21, -0.1, -0.31, -0.52, -0.54, -0.55, -0.54, -0.52};

double Cubic(double x) {
  return 0.3 + x * (-1.1 + x * (0.7 + 0.4 * x));
}

void ExpectDerivatives(const PiecewisePolynomial& f, double x) {
  const auto ahead = f.At(x + kStep);
  const auto behind = f.At(x - kStep);
  EXPECT_NEAR(f.At(x).first, (ahead.value - behind.value) / (2 * kStep), kDifference) << x;
  EXPECT_NEAR(f.At(x).second, (ahead.first - behind.first) / (2 * kStep), kDifference) << x;
}

// The end conditions are exact for a cubic, which a natural spline (zero second derivative at the ends) is
// not.
TEST(SimmSpline, ReproducesACubic) {
  for (const std::size_t points : {4U, 5U, 12U}) {
    const std::vector<double> x(kX.begin(), kX.begin() + static_cast<std::ptrdiff_t>(points));
    std::vector<double> y;
    for (const double at : x) y.push_back(Cubic(at));
    const auto spline = *PiecewisePolynomial::SimmSpline(x, y);
    for (double at = x.front(); at <= x.back(); at += 0.013)
      EXPECT_NEAR(spline.At(at).value, Cubic(at), kPolynomialRounding);
  }
}

TEST(SimmSpline, IsTheParabolaThroughThreePoints) {
  const auto spline = *PiecewisePolynomial::SimmSpline({0, 1, 3}, {1, 2, 10});
  for (const double x : {0.3, 0.9, 1.7, 2.8}) EXPECT_NEAR(spline.At(x).value, 1 + x * x, kPolynomialRounding);
}

TEST(SimmSpline, PassesThroughItsPointsSmoothly) {
  const auto spline = *PiecewisePolynomial::SimmSpline(kX, kY);
  constexpr double kPolynomialError = 1e-9;
  for (std::size_t i = 0; i < kX.size(); ++i) EXPECT_NEAR(spline.At(kX[i]).value, kY[i], kPolynomialRounding);
  for (std::size_t i = 1; i + 1 < kX.size(); ++i) {
    const auto left = spline.At(kX[i] - kPolynomialError);
    const auto right = spline.At(kX[i]);
    EXPECT_NEAR(left.first, right.first, 1e-6);    // kPolynomialError times a second derivative below 1e3
    EXPECT_NEAR(left.second, right.second, 1e-5);  // kPolynomialError times a third derivative below 1e4
  }
}

TEST(SimmSpline, ContinuesAsAStraightLine) {
  const auto spline = *PiecewisePolynomial::SimmSpline(kX, kY);
  const double end_slope = spline.At(kX.back() - 1e-12).first;
  EXPECT_NEAR(spline.At(5).value, kY.back() + end_slope * (5 - kX.back()),
              1e-10);  // slope 1e-12 before the end
  EXPECT_EQ(spline.At(5).second, 0);
  const double start_slope = spline.At(kX.front()).first;
  EXPECT_NEAR(spline.At(-4).value, kY.front() + start_slope * (-4 - kX.front()), kPolynomialRounding);
  EXPECT_EQ(spline.At(-4).second, 0);
}

TEST(PiecewisePolynomial, DerivativesAgreeWithDifferences) {
  const auto spline = *PiecewisePolynomial::SimmSpline(kX, kY);
  const auto lines = *PiecewisePolynomial::Lines(kX, kY);
  const auto polynomial = PiecewisePolynomial::Polynomial({0.3, -1.1, 0.7, 0.4});
  for (double x = -2.5; x < 2.5; x += 0.0377) {
    ExpectDerivatives(spline, x);
    ExpectDerivatives(lines, x);
    ExpectDerivatives(polynomial, x);
    ExpectDerivatives(spline.Scaled(-2.5), x);
  }
}

TEST(PiecewisePolynomial, LinesInterpolateAndExtrapolate) {
  const auto lines = *PiecewisePolynomial::Lines({0, 1, 3}, {0, 2, 0});
  EXPECT_NEAR(lines.At(0.5).value, 1, kPolynomialRounding);
  EXPECT_NEAR(lines.At(2).value, 1, kPolynomialRounding);
  EXPECT_NEAR(lines.At(-1).value, -2, kPolynomialRounding);
  EXPECT_NEAR(lines.At(4).value, -1, kPolynomialRounding);
}

TEST(PiecewisePolynomial, RecognisesASingleLine) {
  EXPECT_EQ(PiecewisePolynomial::Linear(1, 0).Slope(), 1.0);
  EXPECT_EQ(PiecewisePolynomial::Linear(1, 0).Scaled(-2).Slope(), -2.0);
  EXPECT_EQ(PiecewisePolynomial::Constant(3).Slope(), 0.0);
  EXPECT_EQ(PiecewisePolynomial::Polynomial({0, 1, 2}).Slope(), std::nullopt);
  EXPECT_EQ(PiecewisePolynomial::SimmSpline(kX, kY)->Slope(), std::nullopt);
}

TEST(PiecewisePolynomial, RejectsBadPoints) {
  EXPECT_THAT(PiecewisePolynomial::SimmSpline({0}, {0}).error().message, HasSubstr("1 point(s)"));
  EXPECT_THAT(PiecewisePolynomial::SimmSpline({0, 1}, {0}).error().message, HasSubstr("2 x but 1 y"));
  EXPECT_THAT(PiecewisePolynomial::SimmSpline({0, 1, 1}, {0, 1, 2}).error().message,
              HasSubstr("does not increase at point 3"));
  EXPECT_THAT(PiecewisePolynomial::Lines({0, NAN}, {0, 1}).error().message, HasSubstr("not finite"));
}

}  // namespace
}  // namespace sinew
