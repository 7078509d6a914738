#include "models/dynamometer/smooth_angle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/quintic_spline.h"
#include "base/random.h"

namespace sinew {
namespace {

constexpr double kRate = 200;

std::vector<double> NoisyMotion(double frequency, double noise, Random& random) {
  std::vector<double> values;
  for (int i = 0; i < 1600; ++i) {
    const double t = i / kRate;
    values.push_back(0.4 * std::sin(2 * std::acos(-1) * frequency * t) + noise * random.Normal());
  }
  return values;
}

double FarthestApart(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

TEST(SmoothAngleTest, SlowMotionInNoiseGetsALowCutOff) {
  Random random(1);
  const auto slow = SmoothedAngle(NoisyMotion(0.3, 2e-3, random), kRate, -1);
  ASSERT_TRUE(slow) << slow.error().message;
  EXPECT_GE(slow->cutoff, 2);
  EXPECT_LT(slow->cutoff, 8);
  const auto fast = SmoothedAngle(NoisyMotion(4, 2e-3, random), kRate, -1);
  ASSERT_TRUE(fast) << fast.error().message;
  EXPECT_GT(fast->cutoff, 2 * slow->cutoff);
}

// The cut-off that is found is about as good as the best one, which knows the motion.
TEST(SmoothAngleTest, CutOffIsNearlyTheBest) {
  for (const std::uint64_t seed : {2, 3, 4}) {
    Random random(seed);
    Random silent(seed);
    const auto noisy = NoisyMotion(1, 2e-3, random);
    const auto clean = NoisyMotion(1, 0, silent);
    const auto error = [&](double cutoff) {
      const auto smooth = SmoothedAngle(noisy, kRate, cutoff);
      double squares = 0;
      for (std::size_t i = 0; i < clean.size(); ++i) squares += std::pow(smooth->values[i] - clean[i], 2);
      return std::sqrt(squares / static_cast<double>(clean.size()));
    };
    double best = error(0);
    for (double f = 2; f <= 40; f *= 1.15) best = std::min(best, error(f));
    EXPECT_LT(error(-1), 1.2 * best) << "seed " << seed;
    EXPECT_LT(error(-1), 0.5 * error(0)) << "seed " << seed;
  }
}

TEST(SmoothAngleTest, AnAngleWithoutNoiseStaysAsItIs) {
  Random random(5);
  for (const double frequency : {0.3, 1.0, 4.0}) {
    const auto clean = NoisyMotion(frequency, 0, random);
    const auto smooth = SmoothedAngle(clean, kRate, -1);
    ASSERT_TRUE(smooth) << smooth.error().message;
    EXPECT_LT(FarthestApart(smooth->values, clean), 1e-3) << frequency << " Hz";
  }
}

// Whatever the rate: the second derivative is right from the first sample on.
TEST(SmoothAngleTest, TheFilterHasSettledWhereTheAngleBegins) {
  constexpr double kFast = 1000;
  const double way = 2 * std::acos(-1);
  std::vector<double> clean;
  for (int i = 0; i <= 2000; ++i) clean.push_back(0.4 * std::sin(way * i / kFast));
  const auto smooth = SmoothedAngle(clean, kFast, 10);
  ASSERT_TRUE(smooth) << smooth.error().message;
  for (std::size_t i = 1; i + 1 < clean.size(); ++i) {
    const double found = smooth->values[i + 1] - 2 * smooth->values[i] + smooth->values[i - 1];
    EXPECT_NEAR(found * kFast * kFast, -0.4 * way * way * std::sin(way * static_cast<double>(i) / kFast), 0.1)
        << i;
  }
}

struct Turning {
  double noise;  // of the angle [rad]
  double turn;   // of a change of direction: standard deviation [s]
};

// True accelerations of a plate that turns round and back, and those that are found from its noisy angle.
struct Accelerations {
  std::vector<double> truth;
  std::vector<double> found;
};

void AddRecord(const Turning& of, Random& random, Accelerations& to) {
  constexpr double kSpeed = 1.5;  // [rad/s]
  constexpr double kStep = 1e-3;  // far shorter than a turn
  constexpr int kEvery = 10;      // steps per sample
  const double begin = random.Uniform(0.2, 0.5);
  const double peak = 2 * kSpeed / (of.turn * std::sqrt(2 * std::acos(-1)));
  const auto acceleration = [&](double t) {
    double sum = 0;
    for (int k = 0; k < 4; ++k)
      sum += (k % 2 == 0 ? -peak : peak) * std::exp(-0.5 * std::pow((t - begin - 0.7 * k) / of.turn, 2));
    return sum;
  };
  double angle = 0;
  double velocity = kSpeed;
  std::vector<double> time;
  std::vector<double> noisy;
  for (int i = 0; i <= 3000; ++i) {
    const double t = kStep * i;
    if (i % kEvery == 0) {
      time.push_back(t);
      noisy.push_back(angle + of.noise * random.Normal());
    }
    const double next = velocity + 0.5 * kStep * (acceleration(t) + acceleration(t + kStep));
    angle += 0.5 * kStep * (velocity + next);
    velocity = next;
  }
  const auto smooth = SmoothedAngle(noisy, 1 / (kStep * kEvery), -1);
  ASSERT_TRUE(smooth);
  const auto spline = NaturalQuinticSpline::Fit(time, smooth->values);
  ASSERT_TRUE(spline);
  for (const double t : time) {
    to.truth.push_back(acceleration(t));
    to.found.push_back(spline->At(t).second);
  }
}

// What is regressed on an acceleration that still has noise comes out too small (errors in variables); not so
// where the acceleration is the expected one, given the noisy angle. With a filter of second order the two
// ratios are 0.990 and 0.999, with a cubic spline 0.997 and 0.991.
TEST(SmoothAngleTest, TheAccelerationAttenuatesNothing) {
  constexpr int kRecords = 40;
  for (const Turning& of : {Turning{1e-3, 0.04}, Turning{2e-4, 0.02}}) {
    Random random(7);
    Accelerations all;
    for (int record = 0; record < kRecords; ++record) AddRecord(of, random, all);
    double product = 0;
    double squares = 0;
    double missed = 0;
    for (std::size_t i = 0; i < all.found.size(); ++i) {
      product += all.found[i] * all.truth[i];
      squares += all.found[i] * all.found[i];
      missed += std::pow(all.found[i] - all.truth[i], 2);
    }
    EXPECT_NEAR(product / squares, 1, 4e-3) << of.noise;
    EXPECT_LT(missed, 0.01 * squares) << of.noise;
  }
}

TEST(SmoothAngleTest, CutOffsThatDoNothing) {
  Random random(6);
  const auto noisy = NoisyMotion(1, 2e-3, random);
  for (const double cutoff : {0.0, 0.41 * kRate}) {
    const auto smooth = SmoothedAngle(noisy, kRate, cutoff);
    ASSERT_TRUE(smooth);
    EXPECT_EQ(smooth->values, noisy);
    EXPECT_EQ(smooth->cutoff, 0);
  }
  EXPECT_EQ(SmoothedAngle(noisy, kRate, 15)->cutoff, 15);
}

TEST(SmoothAngleTest, TooFewSamplesAreAnError) {
  const auto smooth = SmoothedAngle({0.1, 0.2}, kRate, -1);
  ASSERT_FALSE(smooth);
  EXPECT_FALSE(smooth.error().message.empty());
}

}  // namespace
}  // namespace sinew
