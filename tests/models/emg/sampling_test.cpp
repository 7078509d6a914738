#include "models/emg/sampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/constants.h"

namespace sinew {
namespace {

std::vector<double> Clock(double rate_Hz, int samples, double start_s = 0) {
  std::vector<double> time;
  for (int k = 0; k < samples; ++k) time.push_back(start_s + k / rate_Hz);
  return time;
}

TEST(UniformRateTest, IsThatOfTheTimes) {
  EXPECT_NEAR(*UniformRate(Clock(2048, 100, -3)), 2048, 1e-6);
  auto jitter = Clock(1000, 100);
  jitter[50] += 4e-4;
  EXPECT_NEAR(*UniformRate(jitter), 1000, 1e-9);
}

TEST(UniformRateTest, RefusesMissingSamples) {
  auto time = Clock(1000, 100, 2);
  time.erase(time.begin() + 50, time.begin() + 54);
  const auto rate = UniformRate(time);
  ASSERT_FALSE(rate);
  EXPECT_EQ(rate.error().message,
            "the samples are not evenly spaced: a step of 0.005 s after t = 2.049 s, 0.001 s elsewhere");
  EXPECT_FALSE(UniformRate({1.0}));
  EXPECT_FALSE(UniformRate({}));
}

// 2048 Hz is no multiple of 200 Hz.
TEST(SampleAtRateTest, KeepsTimesAndValues) {
  const auto time = Clock(2048, 20481, 1.5);
  std::vector<double> values;
  values.reserve(time.size());
  for (const double t : time) values.push_back(0.5 + 0.5 * std::sin(2 * kPi * 6 * t));
  const SampledSignal sampled = SampleAtRate(time, values, 200);
  ASSERT_EQ(sampled.time.size(), 2001U);
  EXPECT_EQ(sampled.time.front(), 1.5);
  EXPECT_NEAR(sampled.time.back(), 11.5, 1e-12);
  const double bound = std::pow(2 * kPi * 6 / 2048, 2) / 8;
  for (std::size_t k = 0; k < sampled.time.size(); ++k) {
    EXPECT_NEAR(sampled.time[k], 1.5 + 0.005 * static_cast<double>(k), 1e-12);
    EXPECT_NEAR(sampled.values[k], 0.5 + 0.5 * std::sin(2 * kPi * 6 * sampled.time[k]), bound);
  }
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  for (const double value : sampled.values) EXPECT_TRUE(value >= *low && value <= *high);
}

TEST(SampleAtRateTest, SelectsSamplesForAnIntegerFactor) {
  const auto time = Clock(1000, 101);
  std::vector<double> values;
  for (int k = 0; k < 101; ++k) values.push_back(k * k);
  const SampledSignal sampled = SampleAtRate(time, values, 200);
  ASSERT_EQ(sampled.values.size(), 21U);
  for (std::size_t k = 0; k < 21; ++k)
    EXPECT_NEAR(sampled.values[k], 25.0 * static_cast<double>(k * k), 1e-9);
  EXPECT_EQ(SampleAtRate({2.0}, {7.0}, 200).values, std::vector<double>{7.0});
}

}  // namespace
}  // namespace sinew
