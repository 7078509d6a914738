#include "identify/statistics/student_t.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace sinew::statistics {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
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
  constexpr double kPi = 3.14159265358979323846;
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

TEST(StudentT, IsSymmetricAndRejectsInvalidArguments) {
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
