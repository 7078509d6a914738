#include "models/muscle/activation.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sinew {
namespace {

constexpr double kStep = 1e-6;

TEST(ExponentialShapeTest, IsTheFormula) {
  for (const double shape : {-5.0, -2.0, -0.3, -1.1e-3, -0.9e-3, -1e-6, 0.0, 1e-4, 0.5}) {
    for (const double u : {-0.1, 0.0, 0.2, 0.5, 0.9, 1.0, 1.2}) {
      const long double a = shape;
      const long double exact = shape == 0 ? static_cast<long double>(u)
                                           : std::expm1(a * static_cast<long double>(u)) / std::expm1(a);
      EXPECT_NEAR(ExponentialShape(u, shape).activation, static_cast<double>(exact), 2e-13)
          << shape << " " << u;
    }
  }
}

TEST(ExponentialShapeTest, SlopesAreThoseOfDifferences) {
  for (const double shape : {-5.0, -0.3, -2e-3, -5e-4, 0.0, 0.4}) {
    for (const double u : {0.0, 0.3, 0.7, 1.0}) {
      const ShapeValue at = ExponentialShape(u, shape);
      EXPECT_NEAR(
          at.by_excitation,
          (ExponentialShape(u + kStep, shape).activation - ExponentialShape(u - kStep, shape).activation) /
              (2 * kStep),
          1e-8);
      EXPECT_NEAR(
          at.by_shape,
          (ExponentialShape(u, shape + kStep).activation - ExponentialShape(u, shape - kStep).activation) /
              (2 * kStep),
          1e-8)
          << shape << " " << u;
    }
  }
}

TEST(ExponentialShapeTest, StaysFiniteForExtremeNumbers) {
  for (const double shape : {-1e6, -700.0, 700.0, 1e6}) {
    for (const double u : {-10.0, 0.0, 0.5, 10.0}) {
      const ShapeValue at = ExponentialShape(u, shape);
      EXPECT_TRUE(std::isfinite(at.activation) && std::isfinite(at.by_excitation) &&
                  std::isfinite(at.by_shape))
          << shape << " " << u;
    }
  }
}

// CEINMS: m = p b / (b X0 + 1), b = (exp(Y0 / p) - 1) / X0.
TEST(PiecewiseShapeTest, PassesThroughItsCornerAndItsEnds) {
  for (const double shape : {1e-6, 0.01, 0.06, 0.12}) {
    const double x = 0.3085 - 0.7071 * shape;
    const double y = 0.3085 + 0.7071 * shape;
    EXPECT_NEAR(PiecewiseShape(0, shape).activation, 0, 1e-15);
    EXPECT_NEAR(PiecewiseShape(1, shape).activation, 1, 1e-15);
    const ShapeValue below = PiecewiseShape(x - 1e-12, shape);
    const ShapeValue above = PiecewiseShape(x, shape);
    EXPECT_NEAR(below.activation, y, 1e-11);
    EXPECT_NEAR(above.activation, y, 1e-11);
    EXPECT_NEAR(below.by_excitation, above.by_excitation, 1e-9);
  }
  for (const double u : {-0.1, 0.1, 0.5}) EXPECT_NEAR(PiecewiseShape(u, 1e-8).activation, u, 1e-7);
}

TEST(PiecewiseShapeTest, SlopesAreThoseOfDifferences) {
  for (const double shape : {1e-3, 0.05, 0.11}) {
    for (const double u : {-0.1, 0.05, 0.2, 0.6}) {
      const ShapeValue at = PiecewiseShape(u, shape);
      EXPECT_NEAR(
          at.by_excitation,
          (PiecewiseShape(u + kStep, shape).activation - PiecewiseShape(u - kStep, shape).activation) /
              (2 * kStep),
          1e-8);
      EXPECT_NEAR(
          at.by_shape,
          (PiecewiseShape(u, shape + kStep).activation - PiecewiseShape(u, shape - kStep).activation) /
              (2 * kStep),
          1e-7)
          << shape << " " << u;
    }
  }
}

// After a step of the excitation, distinct poles p, q leave 1 - (p^(k+2) (1 - q) - q^(k+2) (1 - p)) / (p - q)
// after k + 1 samples ... which the sum of both geometric tails says.
TEST(ExcitationFilterTest, StepResponseIsThatOfTwoPoles) {
  const double p = 0.6;
  const double q = 0.3;
  ExcitationFilter<double> filter(
      FilterOfCoefficients(-(p + q) / 2, std::pow((p - q) / 2 / (1 - (p + q) / 2), 2)));
  filter.Settle(0.0);
  for (int k = 0; k < 30; ++k) {
    double exact = 0;  // convolution of the two geometric responses
    for (int i = 0; i <= k; ++i)
      exact += (1 - p) * (1 - q) * (std::pow(p, i + 1) - std::pow(q, i + 1)) / (p - q);
    EXPECT_NEAR(filter.Next(1.0), exact, 1e-13) << k;
  }
}

TEST(ExcitationFilterTest, AConstantExcitationPasses) {
  ExcitationFilter<double> filter(FilterOfCoefficients(-0.25, 0.4225 / 0.5625));
  filter.Settle(0.37);
  for (int k = 0; k < 10; ++k) EXPECT_NEAR(filter.Next(0.37), 0.37, 1e-14);
}

// Also where both poles are equal.
TEST(ExcitationFilterTest, SensitivitiesAreThoseOfDifferences) {
  const auto run = [](const auto& coefficients, auto u) {
    ExcitationFilter<decltype(u)> filter(coefficients);
    for (int k = 0; k < 25; ++k) u = filter.Next(0.5 + 0.4 * std::sin(0.7 * k));
    return u;
  };
  for (const double spread : {0.0, 0.01}) {
    const auto by_c = [&](double m, double s) { return run(FilterOfCoefficients(m, s), 0.0); };
    const auto u =
        run(FilterOfCoefficients(Dual<2>::Variable(-0.5, 0), Dual<2>::Variable(spread, 1)), Dual<2>());
    EXPECT_EQ(u.value, by_c(-0.5, spread));
    EXPECT_NEAR(u.d[0], (by_c(-0.5 + kStep, spread) - by_c(-0.5 - kStep, spread)) / (2 * kStep), 1e-8);
    EXPECT_NEAR(u.d[1], (by_c(-0.5, spread + kStep) - by_c(-0.5, spread - kStep)) / (2 * kStep), 1e-8);
    const auto by_time = [&](double t, double s) { return run(FilterOfTimes(t, s, 0.01), 0.0); };
    const auto v =
        run(FilterOfTimes(Dual<2>::Variable(0.03, 0), Dual<2>::Variable(30 * spread, 1), 0.01), Dual<2>());
    EXPECT_EQ(v.value, by_time(0.03, 30 * spread));
    EXPECT_NEAR(v.d[0],
                (by_time(0.03 + kStep, 30 * spread) - by_time(0.03 - kStep, 30 * spread)) / (2 * kStep),
                1e-6);
    EXPECT_NEAR(v.d[1],
                (by_time(0.03, 30 * spread + kStep) - by_time(0.03, 30 * spread - kStep)) / (2 * kStep),
                1e-7);
  }
}

// Rates (1 + s) / time and (1 - s) / time.
TEST(ExcitationFilterTest, TimesAreThoseOfTwoPoles) {
  for (const double spread : {0.0, 1e-6, 0.25, 0.81}) {
    const double s = std::sqrt(spread);
    const double p = std::exp(-0.01 * (1 + s) / 0.02);
    const double q = std::exp(-0.01 * (1 - s) / 0.02);
    const auto filter = FilterOfTimes(0.02, spread, 0.01);
    EXPECT_NEAR(filter.beta1, -(p + q), 1e-14);
    EXPECT_NEAR(filter.beta2, p * q, 1e-14);
  }
}

TEST(ShapedTest, CarriesBothSlopes) {
  const auto u = Dual<2>::Variable(0.4, 0);
  const auto shape = Dual<2>::Variable(-1.5, 1);
  const auto a = Shaped(ActivationShape::kExponential, u, shape);
  const ShapeValue at = ExponentialShape(0.4, -1.5);
  EXPECT_EQ(a.value, at.activation);
  EXPECT_EQ(a.d[0], at.by_excitation);
  EXPECT_EQ(a.d[1], at.by_shape);
}

// At 1 kHz and at 10 kHz the same signal leaves alike.
TEST(ExcitationFilterTest, TimesDoNotDependOnTheRate) {
  const auto after = [](double step) {
    ExcitationFilter<double> filter(FilterOfTimes(0.02, 0.1, step));
    filter.Settle(0.0);
    double u = 0;
    for (double t = step; t < 0.1 + 1e-9; t += step) u = filter.Next(1.0);
    return u;
  };
  EXPECT_NEAR(after(1e-3), after(1e-4), 0.015);
  EXPECT_NEAR(after(1e-4), after(1e-5), 0.0015);
}

}  // namespace
}  // namespace sinew
