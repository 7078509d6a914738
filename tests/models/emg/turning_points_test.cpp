#include "models/emg/turning_points.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/models/emg/motions.h"

namespace sinew {
namespace {

constexpr double kShare = 0.377;  // where recordings begin: no sample lies on a turning point

struct Errors {
  std::size_t count = 0;
  double worst_s = 0;
  double rms_s = 0;
};

Errors TopErrors(const Motion& motion, double rate_Hz, double noise) {
  const Recording r = Record(motion, kShare, 40.3, rate_Hz, noise);
  Errors errors;
  for (const TurningPoint& point : FindTurningPoints(r.time, r.angle, 22, noise)) {
    if (!point.highest) continue;
    const double off = OffTheTop(motion, kShare, point.time_s);
    ++errors.count;
    errors.worst_s = std::max(errors.worst_s, std::abs(off));
    errors.rms_s += off * off;
    EXPECT_LE(point.from_s, point.time_s);
    EXPECT_GE(point.to_s, point.time_s);
  }
  errors.rms_s = std::sqrt(errors.rms_s / static_cast<double>(errors.count));
  return errors;
}

// What is left is the corner between two samples, of at least 8 that were used: 1 % of a sample.
TEST(TurningPointsTest, SymmetricTurnsAreTimedToAHundredthOfASample) {
  for (const double rate : {50.0, 100.0, 500.0, 2000.0}) {
    for (const double speed : {30.0, 60.0, 90.0, 120.0}) {
      for (const double rest : {0.0, 0.2}) {
        const Errors errors = TopErrors(ConstantSpeeds(speed, speed, rest), rate, 0);
        EXPECT_EQ(errors.count, 40U);
        EXPECT_LT(errors.worst_s * rate, 0.01) << speed << " deg/s, rest " << rest << ", " << rate << " Hz";
      }
    }
    EXPECT_LT(TopErrors(Cosine(1.3), rate, 0).worst_s * rate, 0.01) << rate;
  }
}

// The extreme sample lies below the corner, by up to a sample's step, which shifts the extrapolation.
TEST(TurningPointsTest, UnequalSpeedsShiftNothing) {
  for (const double rate : {50.0, 100.0, 500.0, 2000.0}) {
    for (const auto& [down, up] : {std::pair{30.0, 60.0}, std::pair{120.0, 60.0}, std::pair{45.0, 90.0}})
      EXPECT_LT(TopErrors(ConstantSpeeds(down, up), rate, 0).worst_s * rate, 0.15) << down << " " << rate;
  }
  // The middle of the chord at 10 % of the swing would be 38 ms off.
  EXPECT_LT(TopErrors(ConstantSpeeds(30, 60), 2000, 0).worst_s, 1e-4);
}

// The second harmonic leans the peak: 22.5 (cos x + 0.15 sin 2x) has its top at x with sin x = 0.3 cos 2x.
TEST(TurningPointsTest, FindsTheTopOfALeaningPeak) {
  Motion motion{1, 0, [](double t) { return 22.5 * (std::cos(2 * kPi * t) + 0.15 * std::sin(4 * kPi * t)); }};
  double x = 0.3;
  for (int i = 0; i < 50; ++i)
    x -= (std::sin(x) - 0.3 * std::cos(2 * x)) / (std::cos(x) + 0.6 * std::sin(2 * x));
  motion.top_s = x / (2 * kPi);
  EXPECT_GT(motion.top_s, 0.03);
  for (const double rate : {50.0, 200.0, 1000.0})
    EXPECT_LT(TopErrors(motion, rate, 0).worst_s, 5e-4) << rate;  // second order in the lean
}

// The best that any method can do with a corner of known slopes, from the samples within 6 standard
// deviations below it (the depth that is used), is sigma / (speed sqrt(n)); the extrapolation from two areas
// has up to three times that. 40 turns: an RMS of 1.5 times the expected one has a chance below 1e-5.
TEST(TurningPointsTest, NoiseIsAveraged) {
  for (const double rate : {100.0, 500.0, 2000.0}) {
    for (const double sigma : {0.05, 0.2, 0.5}) {
      for (const double speed : {30.0, 60.0, 120.0}) {
        const double depth = std::max(6 * sigma, 0.05 * 45);
        const double samples = std::max(8.0, 2 * 2 * depth / speed * rate);
        const double best_s = sigma / (speed * std::sqrt(samples));
        const Errors errors = TopErrors(ConstantSpeeds(speed, speed), rate, sigma);
        EXPECT_EQ(errors.count, 40U);
        EXPECT_LT(errors.rms_s, 1.5 * 3 * best_s) << speed << " deg/s, " << rate << " Hz, noise " << sigma;
      }
    }
  }
}

// Deep in noise the areas reach deeper, down to 6 standard deviations: over 720 turns the ratio to the best
// is 2.7, of which 3 % are chance; at 5 % of the swing alone it would be 3.3.
TEST(TurningPointsTest, MuchNoiseIsAveragedOverMoreSamples) {
  double sum = 0;
  int count = 0;
  for (const double rate : {100.0, 500.0, 2000.0}) {
    for (const double sigma : {1.0, 1.5}) {
      for (const double speed : {30.0, 60.0, 120.0}) {
        const double samples = 4 * 6 * sigma / speed * rate;
        const double ratio = TopErrors(ConstantSpeeds(speed, speed), rate, sigma).rms_s /
                             (sigma / (speed * std::sqrt(samples)));
        sum += ratio * ratio;
        ++count;
      }
    }
  }
  EXPECT_LT(std::sqrt(sum / count), 3);
}

// A converter's steps are no white noise.
TEST(TurningPointsTest, StepsOfTheConverterShiftNothing) {
  for (const double step : {0.05, 0.25}) {
    for (const double speed : {30.0, 120.0}) {
      const Motion motion = ConstantSpeeds(speed, speed, 0.1);
      Recording r = Record(motion, kShare, 20.3, 2000);
      for (double& angle : r.angle) angle = step * std::round(angle / step);
      const auto points = FindTurningPoints(r.time, r.angle, 22, NoiseOfAngle(r.angle));
      EXPECT_EQ(points.size(), 39U);  // 20 highest ones
      for (const TurningPoint& point : points)
        if (point.highest) {
          EXPECT_LT(std::abs(OffTheTop(motion, kShare, point.time_s)), 0.1 * step / speed + 1e-4);
        }
    }
  }
}

TEST(TurningPointsTest, MeasuresTheNoiseAndNotTheMotion) {
  for (const double sigma : {0.05, 0.5}) {
    const Recording r = Record(ConstantSpeeds(60, 60), kShare, 20, 500, sigma);
    // A median of n absolute values has a relative error of 1.2 / sqrt(n), correlated neighbours twice that.
    EXPECT_NEAR(NoiseOfAngle(r.angle), sigma, 0.05 * sigma);
  }
  EXPECT_LT(NoiseOfAngle(Record(Cosine(1), kShare, 20, 50).angle), 1e-3);
  EXPECT_LT(NoiseOfAngle(Record(ConstantSpeeds(60, 60), kShare, 20, 50).angle), 1e-12);
  EXPECT_EQ(NoiseOfAngle({}), 0);
  EXPECT_EQ(NoiseOfAngle({1, 5, 2, 8}), 0);
}

TEST(TurningPointsTest, SmallTurnsBetweenLargeOnesDoNotCount) {
  const std::vector<double> angle{5, 0, 10, 7, 9, 0, 2, 1, 10, 3};
  EXPECT_EQ(FindExtremeSamples(angle, 5), (std::vector<std::size_t>{0, 1, 2, 5, 8, 9}));
  EXPECT_EQ(FindExtremeSamples(angle, 2), (std::vector<std::size_t>{0, 1, 2, 3, 4, 5, 8, 9}));
  EXPECT_EQ(FindExtremeSamples(angle, 11), std::vector<std::size_t>{});
  EXPECT_EQ(FindExtremeSamples({}, 1), std::vector<std::size_t>{});
}

TEST(TurningPointsTest, ExtremesAreCorrectedForNoise) {
  const Recording r = Record(ConstantSpeeds(60, 60, 0.5), kShare, 20, 2000, 0.5);
  for (const TurningPoint& point : FindTurningPoints(r.time, r.angle, 22, 0.5)) {
    EXPECT_NEAR(point.angle, point.highest ? 45 : 0, 0.6);  // the extremes of 1000 samples are 1.6 beyond
    EXPECT_GT(std::abs(r.angle[point.sample] - point.angle), 0.8);
  }
}

}  // namespace
}  // namespace sinew
