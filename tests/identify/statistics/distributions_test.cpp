#include "identify/statistics/distributions.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/constants.h"

namespace sinew::statistics {
namespace {

TEST(ChiSquared, TailsMatchTables) {
  // Abramowitz, Stegun 1964, table 26.8: quantiles to six digits.
  const struct {
    double dof;
    double x;
    double tail;
  } table[] = {{1, 3.84146, 0.05},   {1, 6.63490, 0.01},  {2, 5.99147, 0.05},  {3, 7.81473, 0.05},
               {3, 11.3449, 0.01},   {5, 11.0705, 0.05},  {5, 0.554300, 0.99}, {10, 18.3070, 0.05},
               {10, 29.5883, 0.001}, {20, 31.4104, 0.05}, {30, 50.8922, 0.01}, {100, 124.342, 0.05}};
  for (const auto& row : table) {
    // Five units of the table's last digit, through the density, which is below 0.6 of the tail here.
    EXPECT_NEAR(ChiSquaredUpperTail(row.x, row.dof), row.tail, 1e-5 * row.tail * row.x) << row.dof;
  }
}

TEST(ChiSquared, TailsMatchClosedForms) {
  constexpr double kBoostRounding = 2e-13;
  for (const double x : {0.01, 0.5, 1.9, 2.1, 7.0, 40.0, 600.0}) {
    // Even degrees: exp(-x/2) times the beginning of its inverse's series.
    EXPECT_NEAR(ChiSquaredUpperTail(x, 2) / std::exp(-x / 2), 1, kBoostRounding) << x;
    const double six = std::exp(-x / 2) * (1 + x / 2 + x * x / 8);
    EXPECT_NEAR(ChiSquaredUpperTail(x, 6) / six, 1, kBoostRounding) << x;
    EXPECT_NEAR(ChiSquaredUpperTail(x, 1) / std::erfc(std::sqrt(x / 2)), 1, kBoostRounding) << x;
  }
}

TEST(ChiSquared, TailsFarFromTheMeanAreNotLost) {
  EXPECT_NEAR(ChiSquaredUpperTail(1300, 2) / std::exp(-650.0), 1, 1e-12);
  EXPECT_GT(ChiSquaredUpperTail(1380, 4), 0);  // 1e-297
  EXPECT_EQ(ChiSquaredUpperTail(0, 3), 1);
  EXPECT_EQ(ChiSquaredUpperTail(-1, 1), 1);
  EXPECT_EQ(ChiSquaredUpperTail(kInfinity, 3), 0);
  EXPECT_TRUE(std::isnan(ChiSquaredUpperTail(std::nan(""), 3)));
}

TEST(ChiSquared, ManyDegreesAreNearlyNormal) {
  // Wilson, Hilferty 1931: the cube root is normal; good to a few 1e-6 of the tail at 1e4 degrees.
  for (const double dof : {1e4, 1e5}) {
    const double v = 2 / (9 * dof);
    for (const double z : {-2.0, 0.0, 1.5, 3.0}) {
      const double x = dof * std::pow(1 - v + z * std::sqrt(v), 3);
      EXPECT_NEAR(ChiSquaredUpperTail(x, dof), 0.5 * std::erfc(z / std::sqrt(2.0)), 1e-6) << dof << " " << z;
    }
  }
}

TEST(TwoSidedThreshold, InvertsTheNormalTail) {
  EXPECT_NEAR(TwoSidedThreshold(0.05), 1.959963984540054, 1e-14);
  EXPECT_NEAR(TwoSidedThreshold(0.01), 2.575829303548901, 1e-14);
  for (const double p : {0.999, 0.5, 1e-3, 1e-12, 1e-100, 1e-300}) {
    const double z = TwoSidedThreshold(p);
    EXPECT_NEAR(std::erfc(z / std::sqrt(2.0)) / p, 1, 1e-14 * (1 + z * z)) << p;  // its condition number
  }
  EXPECT_EQ(TwoSidedThreshold(1), 0);
  EXPECT_TRUE(std::isinf(TwoSidedThreshold(0)));
}

// The tables have this many digits.
constexpr double kTableDigits = 5e-4;
// What the difference of two logarithms of gamma functions of 1e5 leaves.
constexpr double kNearRounding = 1e-10;

TEST(StudentT, QuantilesMatchTables) {
  // Abramowitz, Stegun 1964, table 26.10, two-sided 95 %.
  const struct {
    double dof;
    double t;
  } table[] = {{1, 12.706}, {2, 4.303},  {3, 3.182},  {5, 2.571},   {10, 2.228},
               {20, 2.086}, {30, 2.042}, {60, 2.000}, {120, 1.980}, {kInfinity, 1.960}};
  for (const auto& row : table) {
    EXPECT_NEAR(StudentTQuantile(0.975, row.dof), row.t, kTableDigits) << row.dof;
  }
  EXPECT_NEAR(StudentTQuantile(0.995, 10), 3.169, kTableDigits);
  EXPECT_NEAR(StudentTQuantile(0.90, 4), 1.533, kTableDigits);
}

TEST(StudentT, QuantilesMatchClosedForms) {
  // One degree of freedom is the Cauchy distribution; two have an algebraic quantile.
  for (const double p : {0.6, 0.9, 0.975, 0.9999}) {
    const double cauchy = std::tan(kPi * (p - 0.5));
    EXPECT_NEAR(StudentTQuantile(p, 1), cauchy, 1e-10 * cauchy);  // 1 - p has lost digits
    const double two = (2 * p - 1) * std::sqrt(2 / (4 * p * (1 - p)));
    EXPECT_NEAR(StudentTQuantile(p, 2), two, 1e-10 * two);
  }
}

TEST(StudentT, InvertsItsDistribution) {
  for (const double dof : {0.7, 1.0, 3.5, 47.0, 5000.0, 9e4, 2e6, kInfinity}) {
    for (const double p : {0.025, 0.3, 0.8, 0.999}) {
      EXPECT_NEAR(StudentTCdf(StudentTQuantile(p, dof), dof), p, kNearRounding) << dof;
    }
  }
}

TEST(StudentT, IsContinuousWhereTheExpansionTakesOver) {
  EXPECT_NEAR(StudentTQuantile(0.975, 0.999e5), StudentTQuantile(0.975, 1.001e5), 1e-7);  // its slope there
  EXPECT_NEAR(std::pow(StudentTQuantile(0.975, kInfinity), 2), 3.841458820694124, 1e-11);
}

TEST(StudentT, IsSymmetricAndRejectsNonsense) {
  EXPECT_EQ(StudentTQuantile(0.5, 3), 0);
  EXPECT_NEAR(StudentTQuantile(0.025, 7), -StudentTQuantile(0.975, 7), kNearRounding);
  EXPECT_TRUE(std::isnan(StudentTQuantile(0, 3)));
  EXPECT_TRUE(std::isnan(StudentTQuantile(1, 3)));
  EXPECT_TRUE(std::isnan(StudentTQuantile(0.9, 0)));
}

// What a gamma function of a hundred and the continued fraction leave.
constexpr double kFRounding = 1e-12;

TEST(FUpperTail, MatchesClosedForms) {
  for (const double n : {1.0, 2.0, 7.0, 40.0, 300.0}) {
    for (const double f : {1e-6, 0.3, 1.0, 4.0, 25.0, 1e4}) {
      // Two degrees above or below: powers.
      const double above = std::exp(-n / 2 * std::log1p(2 * f / n));
      EXPECT_NEAR(FUpperTail(f, 2, n) / above, 1, kFRounding * n) << f << " " << n;
      const double below = -std::expm1(-n / 2 * std::log1p(2 / (n * f)));
      EXPECT_NEAR(FUpperTail(f, n, 2) / below, 1, kFRounding * n) << f << " " << n;
    }
    // Four above: P(F > f) = y^(n/2) (1 + n/2 (1 - y)), y = n / (n + 4 f), as one integration by parts shows.
    const double y = n / (n + 4 * 3.0);
    EXPECT_NEAR(FUpperTail(3, 4, n) / (std::pow(y, n / 2) * (1 + n / 2 * (1 - y))), 1, kFRounding * n);
  }
}

TEST(FUpperTail, IsRelativelyAccurateInTheTail) {
  for (const double n : {5.0, 20.0, 150.0}) {
    for (const double p : {1e-6, 1e-12, 1e-100}) {
      const double f = n / 2 * std::expm1(-2 / n * std::log(p));
      // The power n / 2 magnifies the rounding of f.
      EXPECT_NEAR(FUpperTail(f, 2, n) / p, 1, kFRounding * n) << n;
    }
  }
}

TEST(FUpperTail, AgreesWithStudentsTAndWithItself) {
  for (const double n : {1.0, 3.5, 12.0, 80.0}) {
    for (const double t : {0.2, 1.0, 2.5}) {
      EXPECT_NEAR(FUpperTail(t * t, 1, n), 2 * (1 - StudentTCdf(t, n)), kFRounding * n);
    }
    // 1 / F has the degrees exchanged.
    for (const double f : {0.05, 0.7, 1.0, 3.0})
      EXPECT_NEAR(FUpperTail(f, 6, n) + FUpperTail(1 / f, n, 6), 1, kFRounding * n);
  }
}

TEST(FUpperTail, IsOneWhereNothingIsAbove) {
  EXPECT_EQ(FUpperTail(0, 3, 9), 1);
  EXPECT_EQ(FUpperTail(-2, 3, 9), 1);
  EXPECT_EQ(FUpperTail(kInfinity, 3, 9), 0);
}

}  // namespace
}  // namespace sinew::statistics
