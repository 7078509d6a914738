#include "models/emg/filter_section.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/constants.h"
#include "models/emg/butterworth.h"

namespace sinew {
namespace {

constexpr double kSectionRate = 1000;

std::vector<double> Sine(double frequency_Hz, int samples) {
  std::vector<double> values;
  for (int k = 0; k < samples; ++k) values.push_back(std::sin(2 * kPi * frequency_Hz * k / kSectionRate));
  return values;
}

// Four seconds are 24 time constants of the filter: what is left of the ends is below 1e-9 in the middle.
TEST(FilterZeroLagTest, HasNoLagAndTheSquaredAmplitude) {
  const auto filter = *ButterworthLowPass(2, 6, kSectionRate);
  const auto in = Sine(9, 8000);
  const auto out = *FilterZeroLag(filter, in);
  const double gain =
      1 / (1 + std::pow(std::tan(kPi * 9 / kSectionRate) / std::tan(kPi * 6 / kSectionRate), 4));
  for (std::size_t k = 3500; k < 4500; ++k) EXPECT_NEAR(out[k], gain * in[k], 1e-9);
}

TEST(FilterZeroLagTest, IsHalfAtTheCutOff) {
  const auto out = *FilterZeroLag(*ButterworthLowPass(2, 10, kSectionRate), Sine(10, 8000));
  EXPECT_NEAR(out[4025], 0.5, 1e-9);  // a crest
}

TEST(FilterZeroLagTest, KeepsAConstantAndAStraightLineToTheEnds) {
  std::vector<double> line;
  for (int k = 0; k < 500; ++k) line.push_back(3 - 0.01 * k);
  const auto flat = *FilterZeroLag(*ButterworthLowPass(4, 20, kSectionRate), std::vector<double>(500, 2.5));
  for (const double value : flat) EXPECT_NEAR(value, 2.5, 1e-9);
  const auto gone = *FilterZeroLag(*ButterworthHighPass(4, 20, kSectionRate), std::vector<double>(500, 2.5));
  for (const double value : gone) EXPECT_NEAR(value, 0, 1e-9);
}

TEST(FilterZeroLagTest, IsTheSameBackwards) {
  auto in = Sine(3, 4000);
  for (std::size_t k = 0; k < in.size(); ++k) in[k] += 1e-4 * static_cast<double>(k);
  const auto filter = *ButterworthLowPass(2, 6, kSectionRate);
  const auto out = *FilterZeroLag(filter, in);
  auto reversed = *FilterZeroLag(filter, std::vector<double>(in.rbegin(), in.rend()));
  for (std::size_t k = 1500; k < 2500; ++k) EXPECT_NEAR(out[k], reversed[in.size() - 1 - k], 1e-9);
}

TEST(FilterZeroLagTest, PadsAsScipyDoes) {
  EXPECT_EQ(ZeroLagPadding(*ButterworthLowPass(1, 6, kSectionRate)), 6U);
  EXPECT_EQ(ZeroLagPadding(*ButterworthLowPass(2, 6, kSectionRate)), 9U);
  EXPECT_EQ(ZeroLagPadding(*ButterworthHighPass(3, 6, kSectionRate)), 12U);
  EXPECT_EQ(ZeroLagPadding(*ButterworthBandPass(3, 6, 60, kSectionRate)), 21U);
}

TEST(FilterZeroLagTest, RejectsTooFewSamplesAndGaps) {
  const auto filter = *ButterworthLowPass(2, 6, kSectionRate);
  const auto none = FilterZeroLag(filter, {});
  ASSERT_FALSE(none);
  const auto few = FilterZeroLag(filter, std::vector<double>(9, 1));
  ASSERT_FALSE(few);
  EXPECT_EQ(few.error().message,
            "9 samples are too few for this filter forward and backward, expected more than 9");
  EXPECT_TRUE(FilterZeroLag(filter, std::vector<double>(10, 1)));
  std::vector<double> gap(20, 1);
  gap[7] = NAN;
  const auto spoilt = FilterZeroLag(filter, gap);
  ASSERT_FALSE(spoilt);
  EXPECT_EQ(spoilt.error().message, "sample 7 is nan, expected a finite number");
}

TEST(CausalFilterTest, SettlesAtOnceAndLags) {
  CausalFilter filter(*ButterworthLowPass(2, 6, kSectionRate));
  filter.Settle(0.4);
  for (int k = 0; k < 100; ++k) EXPECT_NEAR(filter.Next(0.4), 0.4, 1e-11);
  // The delay of slow signals: 2 sin(pi / 4) / (2 pi cut-off) = 37.5 ms.
  filter.Settle(0);
  double last = 0;
  for (int k = 0; k < 1000; ++k) last = filter.Next(0.001 * k);
  EXPECT_NEAR(0.999 - last, std::sqrt(2.0) / (2 * kPi * 6), 1e-5);
}

}  // namespace
}  // namespace sinew
