#include "identify/statistics/chi_squared.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

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
  constexpr double kRounding = 2e-13;
  for (const double x : {0.01, 0.5, 1.9, 2.1, 7.0, 40.0, 600.0}) {
    // Even degrees: exp(-x/2) times the beginning of its inverse's series.
    EXPECT_NEAR(ChiSquaredUpperTail(x, 2) / std::exp(-x / 2), 1, kRounding) << x;
    const double six = std::exp(-x / 2) * (1 + x / 2 + x * x / 8);
    EXPECT_NEAR(ChiSquaredUpperTail(x, 6) / six, 1, kRounding) << x;
    EXPECT_NEAR(std::exp(LogChiSquaredUpperTail(x, 1)) / std::erfc(std::sqrt(x / 2)), 1, kRounding) << x;
  }
}

TEST(ChiSquared, FarTailsHaveTheirLogarithm) {
  EXPECT_NEAR(LogChiSquaredUpperTail(1e5, 2), -5e4, 1e-8);
  // Leading terms of the normal tail: phi(z)/z (1 - 1/z^2 + 3/z^4), z = 100; the next is 1.5e-11.
  const double z = 100;
  constexpr double kPi = 3.14159265358979323846;
  const double expected = -0.5 * z * z - std::log(z) + 0.5 * std::log(2 / kPi) + std::log1p(-1e-4 + 3e-8);
  EXPECT_NEAR(LogChiSquaredUpperTail(z * z, 1), expected, 1e-10);
  EXPECT_GT(ChiSquaredUpperTail(1380, 4), 0);  // 1e-297
  EXPECT_EQ(ChiSquaredUpperTail(0, 3), 1);
  EXPECT_EQ(ChiSquaredUpperTail(-1, 1), 1);
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
    EXPECT_NEAR(LogChiSquaredUpperTail(std::pow(TwoSidedThreshold(p), 2), 1) - std::log(p), 0, 1e-11) << p;
  }
  EXPECT_EQ(TwoSidedThreshold(1), 0);
  EXPECT_TRUE(std::isinf(TwoSidedThreshold(0)));
}

}  // namespace
}  // namespace sinew::statistics
