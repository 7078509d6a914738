#include "models/emg/envelope.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "base/constants.h"

namespace sinew {
namespace {

constexpr double kEmgRate = 2048;
constexpr double kMeanOfRectified = 0.79788456080286536;  // of a normal variable, sqrt(2 / pi)

// Noise of standard deviation sigma(t) on an offset.
template <class Sigma>
std::vector<double> Raw(double seconds, const Sigma& sigma, double offset = 0.2) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<double> raw;
  for (int k = 0; k < seconds * kEmgRate; ++k) raw.push_back(offset + sigma(k / kEmgRate) * normal(random));
  return raw;
}

std::string ErrorOf(const std::vector<double>& raw, const EnvelopeSettings& settings,
                    double rate_Hz = kEmgRate) {
  const auto made = ComputeEnvelope(raw, rate_Hz, settings);
  return made ? "" : made.error().message;
}

// White noise: the high-pass keeps 97 % of its power, the low-pass averages over about 150 samples, whose
// mean of absolute values has a standard deviation of 0.6 / sqrt(150) = 5 % of sigma; 5 of these.
TEST(EnvelopeTest, FollowsTheAmplitudeAndNotTheOffset) {
  const auto sigma = [](double t) { return 1e-3 * (1 + 0.8 * std::sin(2 * kPi * 0.5 * t)); };
  const Envelope envelope = *ComputeEnvelope(Raw(10, sigma), kEmgRate, {});
  ASSERT_EQ(envelope.values.size(), static_cast<std::size_t>(10 * kEmgRate));
  // Near its ends the filter hangs on the first and the last sample, which are chance.
  for (std::size_t k = 400; k + 400 < envelope.values.size(); ++k) {
    const double expected = kMeanOfRectified * sigma(static_cast<double>(k) / kEmgRate);
    EXPECT_NEAR(envelope.values[k], expected, 0.25 * expected + 2e-5) << k;
  }
  EXPECT_EQ(envelope.values[envelope.maximum_at], envelope.maximum);
  EXPECT_EQ(*std::max_element(envelope.values.begin(), envelope.values.end()), envelope.maximum);
  EXPECT_TRUE(envelope.faults.gaps.empty());
}

TEST(EnvelopeTest, ScalesWithTheSignal) {
  const auto raw = Raw(2, [](double) { return 1.0; });
  auto small = raw;
  for (double& value : small) value /= 1024;
  const Envelope one = *ComputeEnvelope(raw, kEmgRate, {});
  const Envelope other = *ComputeEnvelope(small, kEmgRate, {});
  for (std::size_t k = 0; k < one.values.size(); ++k) EXPECT_EQ(one.values[k], 1024 * other.values[k]);
}

// After a burst the low-pass swings below zero.
TEST(EnvelopeTest, CutsAndCountsTheUndershoot) {
  const Envelope envelope =
      *ComputeEnvelope(Raw(4, [](double t) { return t > 1.5 && t < 2.5 ? 1.0 : 1e-6; }), kEmgRate, {});
  EXPECT_GT(envelope.undershoot, 100U);
  EXPECT_LT(envelope.deepest, 0);
  EXPECT_GT(envelope.deepest, -0.1 * envelope.maximum);
  EXPECT_GE(*std::min_element(envelope.values.begin(), envelope.values.end()), 0);
}

// Of white noise a bridged gap changes the envelope by no more than chance does.
TEST(EnvelopeTest, BridgesShortGapsWithoutADip) {
  const auto raw = Raw(4, [](double) { return 1.0; });
  auto gaps = raw;
  std::fill_n(gaps.begin() + 4000, 90, NAN);  // 44 ms
  gaps[100] = gaps[101] = gaps.front() = gaps.back() = NAN;
  const Envelope whole = *ComputeEnvelope(raw, kEmgRate, {});
  const Envelope bridged = *ComputeEnvelope(gaps, kEmgRate, {});
  EXPECT_EQ(TotalSamples(bridged.faults.gaps), 94U);
  for (std::size_t k = 400; k + 400 < raw.size(); ++k)
    EXPECT_NEAR(bridged.values[k], whole.values[k], 0.15) << k;
  EXPECT_EQ(
      ErrorOf(gaps, {30, 6, 4, 0.04}),
      "a gap of 90 samples (0.0439 s) begins 1.953 s after the start, longer than the 0.0400 s that are "
      "bridged; cut the trial around it");
  EXPECT_EQ(ErrorOf(std::vector<double>(5000, NAN), {}), "no sample is a number");
}

TEST(EnvelopeTest, AZeroSignalHasNone) {
  const Envelope envelope = *ComputeEnvelope(std::vector<double>(4000, 0.1234), kEmgRate, {});
  EXPECT_EQ(envelope.maximum, 0);
  EXPECT_EQ(envelope.values, std::vector<double>(4000, 0));
}

TEST(EnvelopeTest, RejectsWhatItCannotFilter) {
  const std::vector<double> raw(4000, 0);
  for (const int order : {0, 3, 18, -2}) {
    EXPECT_EQ(
        ErrorOf(raw, {30, 6, order}),
        "order " + std::to_string(order) +
            ": expected an even number from 2 to 16; half of it is run forward and half of it backward");
  }
  EXPECT_EQ(ErrorOf(raw, {}, 60),
            "cut-off 30 Hz at a sampling rate of 60 Hz: expected at least 0.0006 Hz and less than "
            "half of the rate, 30 Hz");
  EXPECT_EQ(ErrorOf(std::vector<double>(300, 0), {}),
            "300 samples (0.146 s) are too short for a cut-off of 6.00 Hz, expected at least 0.167 s");
  EXPECT_EQ(ErrorOf(raw, {30, 6, 4, NAN}), "longest gap nan s: expected 0 or more");
}

TEST(EnvelopeTest, LowPassAmplitudeIsHalfAtTheCutOff) {
  EXPECT_EQ(LowPassAmplitude({}, 6), 0.5);
  EXPECT_NEAR(LowPassAmplitude({}, 100), 1.3e-5, 1e-6);
}

}  // namespace
}  // namespace sinew
