#include "models/mechanisms/elliptic.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/constants.h"

namespace sinew {
namespace {

constexpr double kRounding = 1e-14;

TEST(Elliptic, CompleteIntegralAgreesWithTables) {
  EXPECT_NEAR(CompleteElliptic(0), kPi / 2, kRounding);
  EXPECT_NEAR(CompleteElliptic(0.5), 1.85407467730137192, kRounding);  // Abramowitz & Stegun, table 17.1
  EXPECT_NEAR(CompleteElliptic(0.98), 3.35414144569916, 1e-13);
}

TEST(Elliptic, CircularFunctionsForParameterZero) {
  for (const double u : {-3.0, -0.2, 0.0, 0.7, 12.5}) {
    const JacobiElliptic f = JacobiEllipticAt(u, 0);
    EXPECT_NEAR(f.sn, std::sin(u), kRounding);
    EXPECT_NEAR(f.cn, std::cos(u), kRounding);
    EXPECT_NEAR(f.dn, 1, kRounding);
  }
}

// d sn / du = cn dn, and so on: what makes them solve a pendulum.
TEST(Elliptic, DerivativesAreThoseOfTheDefinition) {
  constexpr double kStep = 1e-5;
  for (const double m : {0.1, 0.5, 0.978}) {
    for (const double u : {-7.3, -1.1, 0.4, 2.9, 31.0}) {
      const JacobiElliptic f = JacobiEllipticAt(u, m);
      const JacobiElliptic before = JacobiEllipticAt(u - kStep, m);
      const JacobiElliptic after = JacobiEllipticAt(u + kStep, m);
      EXPECT_NEAR((after.sn - before.sn) / (2 * kStep), f.cn * f.dn, 1e-9) << m << ' ' << u;
      EXPECT_NEAR((after.cn - before.cn) / (2 * kStep), -f.sn * f.dn, 1e-9) << m << ' ' << u;
      EXPECT_NEAR((after.dn - before.dn) / (2 * kStep), -m * f.sn * f.cn, 1e-9) << m << ' ' << u;
      EXPECT_NEAR(f.sn * f.sn + f.cn * f.cn, 1, kRounding);
    }
  }
}

TEST(Elliptic, QuarterPeriod) {
  for (const double m : {0.1, 0.5, 0.978}) {
    const JacobiElliptic f = JacobiEllipticAt(CompleteElliptic(m), m);
    EXPECT_NEAR(f.sn, 1, kRounding);
    EXPECT_NEAR(f.cn, 0, 1e-7);
    EXPECT_NEAR(f.dn, std::sqrt(1 - m), 1e-12);
  }
}

}  // namespace
}  // namespace sinew
