// Which residuals are more than the noise that is visible at their high frequencies.
#include "identify/diagnosis/select/visible_noise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace sinew::diagnosis {
namespace {

// Two stretches of white noise of deviation 1 with a sine.
noise::NoiseBlock Residual(double structure, double largest_root = 1) {
  noise::NoiseBlock block;
  block.channel = "force";
  block.largest_root = largest_root;
  block.stretches = {0, 300};
  block.residual = Vector(600);
  Random random(3);
  for (int i = 0; i < 600; ++i) block.residual[i] = structure * std::sin(0.1 * i) + random.Normal();
  return block;
}

TEST(VisibleNoise, IsFoundWhereTheResidualIsMore) {
  EXPECT_TRUE(NoiseBelowMisfit({Residual(0)}).empty());
  EXPECT_TRUE(NoiseBelowMisfit({Residual(1)}).empty());
  EXPECT_TRUE(NoiseBelowMisfit({Residual(6, 0.9)}).empty()) << "its noise is known to be correlated";
  EXPECT_TRUE(NoiseBelowMisfit({}).empty());
  const auto visible = NoiseBelowMisfit({Residual(6)});
  ASSERT_EQ(visible.count("force"), 1U);
  EXPECT_GT(visible.at("force"), 0.9);
  EXPECT_LT(visible.at("force"), 1.5) << "of the residual: 4.4";
}

TEST(VisibleNoise, IsTheNoiseOfThoseChannelsOnly) {
  noise::NoiseModel residual;
  residual.channels.resize(2);
  for (noise::ChannelNoiseModel& channel : residual.channels) {
    channel.deviation = 3;
    channel.coefficients = {0.9};
  }
  residual.channels[0].channel = "force";
  residual.channels[1].channel = "moment";
  const noise::NoiseModel noise = WithVisibleNoise(residual, {{"force", 0.5}});
  EXPECT_EQ(noise.channels[0].ProcessDeviation(), 0.5);
  EXPECT_EQ(noise.channels[1].ProcessDeviation(), residual.channels[1].ProcessDeviation());
}

}  // namespace
}  // namespace sinew::diagnosis
