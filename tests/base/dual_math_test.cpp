#include "base/dual_math.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sinew {
namespace {

using Dual2 = Dual<2>;

// A function of two numbers against differences of its values.
template <class F>
void ExpectDerivatives(const F& f, double x, double y) {
  constexpr double kStep = 6e-6;       // cbrt of rounding
  constexpr double kTolerance = 1e-9;  // of central differences of values of about 1
  const Dual2 got = f(Dual2::Variable(x, 0), Dual2::Variable(y, 1));
  EXPECT_EQ(got.value, f(x, y));
  EXPECT_NEAR(got.d[0], (f(x + kStep, y) - f(x - kStep, y)) / (2 * kStep), kTolerance);
  EXPECT_NEAR(got.d[1], (f(x, y + kStep) - f(x, y - kStep)) / (2 * kStep), kTolerance);
}

TEST(DualMath, FormulasOfPlainNumbersWorkForDualNumbers) {
  ExpectDerivatives([](auto x, auto y) { return sqrt(x) * sin(y) + cos(x * y); }, 0.7, 1.2);
  ExpectDerivatives([](auto x, auto y) { return tan(x) + atan(y) + tanh(x * y); }, 0.7, 1.2);
  ExpectDerivatives([](auto x, auto y) { return exp(-x) * log(y) + sinh(x) / cosh(y); }, 0.7, 1.2);
  ExpectDerivatives([](auto x, auto y) { return pow(x, 1.7) + pow(2.0, y) + pow(x, y); }, 0.7, 1.2);
  ExpectDerivatives([](auto x, auto y) { return atan2(x, y) + abs(x - y) + fabs(y - x); }, 0.7, 1.2);
  ExpectDerivatives([](auto x, auto y) { return max(x, y) * min(x, y) + max(x, 3.0) + min(0.1, y); }, 0.7,
                    1.2);
  ExpectDerivatives([](auto x, auto y) { return positive_part(x - 0.2) + positive_part(0.2 - y); }, 0.7, 1.2);
}

TEST(DualMath, HypotIsTheLengthOfBothSides) {
  const Dual2 got = hypot(Dual2::Variable(3, 0), Dual2::Variable(4, 1));
  EXPECT_DOUBLE_EQ(got.value, 5);
  EXPECT_DOUBLE_EQ(got.d[0], 0.6);
  EXPECT_DOUBLE_EQ(got.d[1], 0.8);
}

TEST(DualMath, SlopesThatAreInfiniteAreSetToZero) {
  EXPECT_EQ(sqrt(Dual2::Variable(0, 0)).d[0], 0);
  EXPECT_EQ(pow(Dual2::Variable(0, 0), Dual2::Variable(2, 1)).d[1], 0);
}

}  // namespace
}  // namespace sinew
