#include "base/dual.h"

#include <gtest/gtest.h>

#include <vector>

#include "base/random.h"

namespace sinew {
namespace {

// All functions of Dual, of three variables; the same text compiles for double.
template <class T>
T Anything(const T& x, const T& y, const T& z) {
  T sum = x * y + 2.0 * z - y / x + 3.0;
  sum += Sin(x * z) - Cos(y) * 0.5;
  sum -= Exp(-(y * y)) / 4.0;
  sum += Sqrt(x) + Log(y + 1.0) + Abs(z - 1.0) * Abs(1.0 - z);
  sum += 1.0 / (x + 2.0 - z / 7.0);
  sum -= 0.25;
  sum += 0.125;
  return -sum + (1.0 + x) * (z - 0.5);
}

TEST(Dual, AgreesWithDifferences) {
  // Central differences: step cbrt(eps), error about its square times third derivatives of at most 1e3.
  constexpr double kStep = 6e-6;
  constexpr double kTolerance = 1e-7;
  Random random(1);
  for (int round = 0; round < 100; ++round) {
    const double at[3] = {random.Uniform(0.3, 3), random.Uniform(0.3, 3), random.Uniform(-2, 3)};
    using D = Dual<3>;
    const D result = Anything(D::Variable(at[0], 0), D::Variable(at[1], 1), D::Variable(at[2], 2));
    for (int k = 0; k < 3; ++k) {
      double up[3] = {at[0], at[1], at[2]};
      double down[3] = {at[0], at[1], at[2]};
      up[k] += kStep;
      down[k] -= kStep;
      const double difference =
          (Anything(up[0], up[1], up[2]) - Anything(down[0], down[1], down[2])) / (2 * kStep);
      EXPECT_NEAR(result.d[static_cast<std::size_t>(k)], difference, kTolerance * (1 + std::abs(difference)));
    }
  }
}

template <int N>
void ExpectBitsOfDouble() {
  Random random(2);
  for (int round = 0; round < 10000; ++round) {
    const double x = random.Uniform(0.1, 30);
    const double y = random.Uniform(0.1, 3);
    const double z = random.Uniform(-50, 50);
    using D = Dual<N>;
    ASSERT_EQ(Value(Anything(D::Variable(x, 0), D(y), D::Variable(z, N - 1))), Anything(x, y, z));
  }
}

TEST(Dual, ValueHasTheBitsOfDoubleWhateverTheNumberOfLanes) {
  ExpectBitsOfDouble<1>();
  ExpectBitsOfDouble<4>();
  ExpectBitsOfDouble<8>();
  ExpectBitsOfDouble<16>();
}

TEST(Dual, SumsOfProductsInOnePassHaveTheBitsOfTwoOperations) {
  using D = Dual<3>;
  Random random(3);
  const auto any = [&] {
    D x(random.Uniform(-3, 3));
    for (double& slope : x.d) slope = random.Uniform(-3, 3);
    return x;
  };
  for (int round = 0; round < 1000; ++round) {
    const D sum = any();
    const D a = any();
    const D b = any();
    D up = sum;
    AddProduct(up, a, b);
    D down = sum;
    SubtractProduct(down, a, b);
    D scaled = sum;
    AddProduct(scaled, a.value, b);
    double plain_up = sum.value;
    AddProduct(plain_up, a.value, b.value);
    double plain_down = sum.value;
    SubtractProduct(plain_down, a.value, b.value);
    ASSERT_EQ(plain_up, up.value);
    ASSERT_EQ(plain_down, down.value);
    const D expected_up = sum + a * b;
    const D expected_down = sum - a * b;
    const D expected_scaled = sum + a.value * b;
    ASSERT_EQ(up.value, expected_up.value);
    ASSERT_EQ(down.value, expected_down.value);
    ASSERT_EQ(scaled.value, expected_scaled.value);
    ASSERT_EQ(up.d, expected_up.d);
    ASSERT_EQ(down.d, expected_down.d);
    ASSERT_EQ(scaled.d, expected_scaled.d);
  }
}

TEST(Dual, TangentLeavesTheValueOut) {
  const auto x = Dual<2>::Variable(3, 1);
  EXPECT_EQ(Tangent(x).value, 0);
  EXPECT_EQ(Tangent(x).d[0], 0);
  EXPECT_EQ(Tangent(x).d[1], 1);
  EXPECT_EQ(Tangent(3.0), 0);
}

TEST(Dual, AConstantHasZeroDerivatives) {
  const Dual<4> x = 2;
  for (const double d : x.d) EXPECT_EQ(d, 0);
}

}  // namespace
}  // namespace sinew
