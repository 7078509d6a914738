// Which residuals are more than the noise that is visible at their high frequencies.
#include "identify/diagnosis/select/noise_below_misfit.h"

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

TEST(NoiseBelowMisfit, IsFoundWhereTheResidualIsMore) {
  EXPECT_TRUE(NoiseBelowMisfit({Residual(0)}).empty());
  EXPECT_TRUE(NoiseBelowMisfit({Residual(1)}).empty());
  EXPECT_TRUE(NoiseBelowMisfit({Residual(6, 0.9)}).empty()) << "its noise is known to be correlated";
  EXPECT_TRUE(NoiseBelowMisfit({}).empty());
  const auto visible = NoiseBelowMisfit({Residual(6)});
  ASSERT_EQ(visible.count("force"), 1U);
  EXPECT_GT(visible.at("force"), 0.9);
  EXPECT_LT(visible.at("force"), 1.5) << "of the residual: 4.4";
}

// Stretches of 20 samples, too short for a spectrum; the data state a level of 1 in each.
std::vector<noise::NoiseBlock> ShortResiduals(double structure, double white) {
  std::vector<noise::NoiseBlock> blocks(3);
  Random random(5);
  for (noise::NoiseBlock& block : blocks) {
    block.channel = "force";
    block.stated = 1;
    block.stretches = {0};
    block.residual = Vector(20);
    for (int i = 0; i < 20; ++i) block.residual[i] = structure * std::sin(0.3 * i) + white * random.Normal();
  }
  return blocks;
}

TEST(NoiseBelowMisfit, IsTheStatedOneBelowAShortSmoothResidual) {
  const auto noise = NoiseBelowMisfit(ShortResiduals(3.5, 1));
  ASSERT_EQ(noise.count("force"), 1U);
  EXPECT_DOUBLE_EQ(noise.at("force"), 1);
  EXPECT_TRUE(NoiseBelowMisfit(ShortResiduals(1.5, 1)).empty()) << "1.5 times the stated level";
  EXPECT_TRUE(NoiseBelowMisfit(ShortResiduals(0, 3)).empty()) << "white: the level is stated too low";
  std::vector<noise::NoiseBlock> mixed = ShortResiduals(3.5, 1);
  mixed[1].stated.reset();
  EXPECT_TRUE(NoiseBelowMisfit(mixed).empty()) << "a level that not all trials state";
  std::vector<noise::NoiseBlock> single = ShortResiduals(3.5, 1);
  for (noise::NoiseBlock& block : single) {
    block.residual.conservativeResize(3);
    block.stretches = {0, 1, 2};
  }
  EXPECT_TRUE(NoiseBelowMisfit(single).empty()) << "no neighbours";
}

TEST(NoiseBelowMisfit, IsTheNoiseOfThoseChannelsOnly) {
  noise::NoiseModel residual;
  residual.channels.resize(2);
  for (noise::ChannelNoiseModel& channel : residual.channels) {
    channel.deviation = 3;
    channel.coefficients = {0.9};
  }
  residual.channels[0].channel = "force";
  residual.channels[1].channel = "moment";
  const noise::NoiseModel noise = WithNoiseBelowMisfit(residual, {{"force", 0.5}});
  EXPECT_EQ(noise.channels[0].ProcessDeviation(), 0.5);
  EXPECT_EQ(noise.channels[1].ProcessDeviation(), residual.channels[1].ProcessDeviation());
}

}  // namespace
}  // namespace sinew::diagnosis
