#include "identify/observation/low_pass.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace sinew {
namespace {

// Irregular times: steps from 0.2 ms to 20 ms.
std::vector<double> IrregularTimes(int count, Random& random) {
  std::vector<double> time{0.3};
  while (static_cast<int>(time.size()) < count) {
    time.push_back(time.back() + 2e-4 * std::pow(100, random.Uniform(0, 1)));
  }
  return time;
}

Vector RandomSignal(int count, Random& random) {
  Vector signal(count);
  for (double& value : signal) value = random.Normal();
  return signal;
}

Vector Filtered(const std::vector<double>& time, const Vector& signal, double time_constant) {
  LowPass filter;
  filter.Set(time, time_constant);
  Vector out = signal;
  filter.Apply(out);
  return out;
}

TEST(LowPass, ARampLagsByTheTimeConstant) {
  constexpr double kRounding = 1e-14;
  Random random(1);
  const auto time = IrregularTimes(100, random);
  for (const double time_constant : {1e-4, 0.01, 0.5}) {
    Vector ramp(100);
    for (int i = 0; i < 100; ++i) ramp[i] = 2 + 3 * time[static_cast<std::size_t>(i)];
    const Vector out = Filtered(time, ramp, time_constant);
    for (int i = 0; i < 100; ++i) EXPECT_NEAR(out[i], ramp[i] - 3 * time_constant, 10 * kRounding);
  }
}

TEST(LowPass, AgreesWithAFineNumericalSolution) {
  // Classical Runge-Kutta with 50 steps in each piece, h / tau <= 0.4 / 50: its error is (h / tau)^4 / 120
  // relative, below 1e-10.
  constexpr double kTolerance = 1e-9;
  constexpr double kTimeConstant = 0.05;
  constexpr int kPieces = 50;
  Random random(2);
  const auto time = IrregularTimes(60, random);
  const Vector signal = RandomSignal(60, random);
  const Vector out = Filtered(time, signal, kTimeConstant);
  double y = signal[0] - kTimeConstant * (signal[1] - signal[0]) / (time[1] - time[0]);
  EXPECT_NEAR(out[0], y, kTolerance);
  for (int i = 1; i < 60; ++i) {
    const double h = time[static_cast<std::size_t>(i)] - time[static_cast<std::size_t>(i) - 1];
    const auto slope = [&](double s, double at) {
      return (signal[i - 1] + s * (signal[i] - signal[i - 1]) - at) / kTimeConstant;
    };
    for (int k = 0; k < kPieces; ++k) {
      const double step = h / kPieces;
      const double s = static_cast<double>(k) / kPieces;
      const double half = 0.5 / kPieces;
      const double k1 = slope(s, y);
      const double k2 = slope(s + half, y + step / 2 * k1);
      const double k3 = slope(s + half, y + step / 2 * k2);
      const double k4 = slope(s + 2 * half, y + step * k3);
      y += step / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    EXPECT_NEAR(out[i], y, kTolerance);
  }
}

TEST(LowPass, ItsDerivativeAgreesWithDifferences) {
  Random random(3);
  const auto time = IrregularTimes(80, random);
  const Vector signal = RandomSignal(80, random);
  for (const double time_constant : {3e-5, 1e-3, 0.02, 0.1, 0.5, 30.0}) {
    const double step = 1e-5 * time_constant;
    // Differences: truncation 1e-10, rounding eps / 1e-5 = 2e-11, both relative to a change by the factor e.
    constexpr double kTolerance = 1e-9;
    LowPass filter;
    filter.Set(time, time_constant);
    Vector slope(80);
    filter.Differentiate(signal, slope);
    const Vector difference =
        (Filtered(time, signal, time_constant + step) - Filtered(time, signal, time_constant - step)) /
        (2 * step);
    // A long time constant lags far behind from the begin.
    const double size = signal.norm() + Filtered(time, signal, time_constant).norm();
    EXPECT_LT(time_constant * (slope - difference).norm(), kTolerance * size) << time_constant;
  }
}

TEST(LowPass, ItsDerivativeForLongTimeConstantsIsTheSeriesBothWays) {
  // On the two sides of the change from series to closed form; what is between differs by the step itself.
  const std::vector<double> time{0, 1};
  const Vector rise = (Vector(2) << 0, 1).finished();
  Vector below(2);
  Vector above(2);
  LowPass filter;
  filter.Set(time, 1 / (1e-2 * (1 - 1e-9)));
  filter.Differentiate(rise, below);
  filter.Set(time, 1 / (1e-2 * (1 + 1e-9)));
  filter.Differentiate(rise, above);
  EXPECT_NEAR(below[1] / above[1], 1, 1e-8);
}

TEST(LowPass, WithoutATimeConstantNothingChangesAndTheSlopeIsTheLimit) {
  Random random(4);
  const auto time = IrregularTimes(50, random);
  const Vector signal = RandomSignal(50, random);
  EXPECT_EQ(Filtered(time, signal, 0), signal);
  EXPECT_EQ(Filtered(time, signal, 1e-320), signal) << "h / 1e-320 is not a number any more";
  LowPass filter;
  Vector at_null(50);
  Vector near_null(50);
  filter.Set(time, 0);
  filter.Differentiate(signal, at_null);
  filter.Set(time, 1e-9);
  filter.Differentiate(signal, near_null);
  EXPECT_DOUBLE_EQ(at_null[0], at_null[1]);
  EXPECT_LT((at_null - near_null).norm(), 1e-12 * at_null.norm());
  for (int i = 1; i < 50; ++i) {
    const auto at = static_cast<std::size_t>(i);
    EXPECT_DOUBLE_EQ(at_null[i], -(signal[i] - signal[i - 1]) / (time[at] - time[at - 1]));
  }
}

TEST(LowPass, AConstantIsUnchanged) {
  const Vector constant = Vector::Constant(20, 3.5);
  Random random(5);
  EXPECT_EQ(Filtered(IrregularTimes(20, random), constant, 0.2), constant);
}

TEST(LowPass, OneSampleIsUnchanged) {
  Vector one = Vector::Constant(1, 2);
  LowPass filter;
  filter.Set({0.5}, 0.2);
  filter.Apply(one);
  EXPECT_EQ(one[0], 2);
  Vector slope = Vector::Constant(1, 7);
  filter.Differentiate(one, slope);
  EXPECT_EQ(slope[0], 0);
}

}  // namespace
}  // namespace sinew
