#include "models/emg/raw_emg.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace sinew {
namespace {

constexpr double kRawRate = 2048;

std::vector<double> Noise(std::size_t samples, double step = 0) {
  std::mt19937 random(1);
  std::vector<double> values;
  values.reserve(samples);
  for (std::size_t k = 0; k < samples; ++k) {
    const double value = static_cast<double>(random()) / 4294967296.0 - 0.5;
    values.push_back(step > 0 ? step * std::round(value / step) : value);
  }
  return values;
}

TEST(RawEmgTest, NoiseHasNoFault) {
  for (const double step : {0.0, 1.0 / 4096, 1.0 / 16, 1.0 / 2}) {
    const RawEmgFaults faults = FindRawEmgFaults(Noise(200000, step), kRawRate);
    EXPECT_FALSE(faults.silent);
    EXPECT_TRUE(faults.gaps.empty() && faults.clipped.empty() && faults.frozen.empty()) << step;
  }
}

TEST(RawEmgTest, FindsClippingAtBothEnds) {
  auto raw = Noise(1000);
  for (double& value : raw) value = std::clamp(value, -0.2, 0.2);
  for (int k = 0; k < 5; ++k) raw[100 + k] = 0.2;
  raw[99] = raw[105] = 0;
  for (int k = 0; k < 4; ++k) raw[300 + k] = -0.2;
  raw[299] = raw[304] = 0;
  const RawEmgFaults faults = FindRawEmgFaults(raw, kRawRate);
  const auto has = [&](std::size_t first, std::size_t count) {
    return std::any_of(faults.clipped.begin(), faults.clipped.end(),
                       [&](const SampleRun& run) { return run.first == first && run.count == count; });
  };
  EXPECT_TRUE(has(100, 5));
  EXPECT_TRUE(has(300, 4));
  EXPECT_TRUE(faults.frozen.empty());
}

TEST(RawEmgTest, FindsGapsAndFrozenSamples) {
  auto raw = Noise(2000);
  for (int k = 0; k < 10; ++k) raw[500 + k] = NAN;
  raw[700] = NAN;
  std::fill_n(raw.begin() + 1000, 60, 0.0);
  const RawEmgFaults faults = FindRawEmgFaults(raw, kRawRate);
  ASSERT_EQ(faults.gaps.size(), 2U);
  EXPECT_EQ(TotalSamples(faults.gaps), 11U);
  EXPECT_EQ(LongestRun(faults.gaps).first, 500U);
  ASSERT_EQ(faults.frozen.size(), 1U);
  EXPECT_EQ(faults.frozen[0].first, 1000U);
  EXPECT_EQ(faults.frozen[0].count, 60U);
  EXPECT_TRUE(faults.clipped.empty());
}

TEST(RawEmgTest, FindsALooseElectrode) {
  EXPECT_TRUE(FindRawEmgFaults(std::vector<double>(100, 0.3), kRawRate).silent);
  EXPECT_TRUE(FindRawEmgFaults(std::vector<double>(100, NAN), kRawRate).silent);
  EXPECT_TRUE(FindRawEmgFaults({}, kRawRate).silent);
}

}  // namespace
}  // namespace sinew
