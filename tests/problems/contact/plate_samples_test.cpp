#include "problems/contact/load/plate_samples.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <limits>

#include "base/random.h"
#include "identify/observation/later_readings.h"

namespace sinew {
namespace {

using testing::DoubleNear;
using testing::Each;
using testing::ElementsAre;

constexpr double kPlateRate = 1000;  // [Hz] of the plate
constexpr double kFrameRate = 100;   // [Hz] of the motion
constexpr double kAnyLevel = std::numeric_limits<double>::infinity();

Channel ChannelOf(const Grid& grid, const std::function<double(double)>& value) {
  Channel channel{"N", ChannelKind::kMeasured, 2.0, {}};
  for (const double t : grid.time) channel.values.push_back(value(t));
  return channel;
}

Grid Record(double seconds, double rate = kPlateRate) {
  Grid grid;
  for (int i = 0; i <= std::lround(seconds * rate); ++i) grid.time.push_back(i / rate);
  return grid;
}

// Frames from `first` on.
Block Frames(double first, int count) {
  Block block;
  for (int i = 0; i < count; ++i) block.prediction_time.push_back(first + i / kFrameRate);
  return block;
}

Block FitsOf(const Grid& grid, const Channel& channel, Block block) {
  AddLocalFits(grid, channel, "p", false, 0, channel.sigma.value_or(kAnyLevel), block);
  return block;
}

// A force that rises as fast as that of a foot at touch-down is read as it is at the frames: a mean over the
// samples from half a frame before to half a frame after it, the last one left out, would be 5 N too early.
TEST(PlateSamples, ACubicIsReadExactly) {
  const Grid grid = Record(0.3);
  const auto cubic = [](double t) { return 1e4 * t - 3e4 * t * t + 2e5 * t * t * t; };
  const Block block = FitsOf(grid, ChannelOf(grid, cubic), Frames(0.05, 20));
  ASSERT_EQ(block.samples(), 20);
  for (int i = 0; i < block.samples(); ++i) {
    const double t = block.prediction_time[static_cast<std::size_t>(i)];
    EXPECT_NEAR(block.measured[static_cast<std::size_t>(i)], cubic(t), 1e-8) << t;
  }
}

TEST(PlateSamples, WhatIsSlowerThanTheFramesStaysAndFastVibrationsAreSmoothed) {
  const Grid grid = Record(2.5);
  const auto gain_at = [&](double frequency) {
    const Block block =
        FitsOf(grid, ChannelOf(grid, [&](double t) { return std::cos(2 * M_PI * frequency * (t - 1)); }),
               Frames(1, 1 + static_cast<int>(kFrameRate)));
    return block.measured.front();
  };
  EXPECT_NEAR(gain_at(10), 1, 1e-4);
  EXPECT_NEAR(gain_at(40), 1, 1e-2);
  EXPECT_LT(std::abs(gain_at(330)), 0.3);
}

// Friction turns round within two frames: a parabola through the samples of half a frame would be 20 N off.
TEST(PlateSamples, WhereTheForceTurnsRoundOneSampleIsRead) {
  const Grid grid = Record(0.3);
  const auto force = [](double t) { return 500 * std::tanh((t - 0.15) / 0.002) + 100 * t; };
  const Block block = FitsOf(grid, ChannelOf(grid, force), Frames(0.053, 20));
  ASSERT_EQ(block.samples(), 20);
  ASSERT_EQ(block.relative_weight.size(), 20U);
  const double wide = std::sqrt(17 / 35.0);  // noise of Savitzky and Golay's five samples
  int narrow = 0;
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_NEAR(block.measured[i], force(block.prediction_time[i]), 0.5) << block.prediction_time[i];
    const bool turning = std::abs(block.prediction_time[i] - 0.15) < 0.009;
    EXPECT_NEAR(block.relative_weight[i], turning ? wide : 1, 1e-9) << block.prediction_time[i];
    narrow += turning ? 1 : 0;
  }
  EXPECT_EQ(narrow, 2);
  EXPECT_NEAR(*block.sigma, 2 * wide, 1e-9);
  // Beside an error that is larger than all this nothing bends.
  Block any = Frames(0.053, 20);
  AddLocalFits(grid, ChannelOf(grid, force), "p", false, 0, kAnyLevel, any);
  for (const double weight : any.relative_weight) EXPECT_NEAR(weight, 1, 1e-9);
}

TEST(PlateSamples, SigmaIsThatOfTheFits) {
  const Grid grid = Record(40);
  Random random(7);
  const Block block =
      FitsOf(grid, ChannelOf(grid, [&](double) { return 2 * random.Normal(); }), Frames(0.05, 3900));
  double squares = 0;
  for (const double value : block.measured) squares += value * value;
  EXPECT_NEAR(std::sqrt(squares / 3900), *block.sigma, 0.05 * *block.sigma);
  EXPECT_NEAR(*block.sigma, 2 * std::sqrt(17 / 35.0), 1e-9) << "Savitzky and Golay's, of five samples";
}

TEST(PlateSamples, ARecordAsFineAsTheMotionIsReadAsItIs) {
  const Grid grid = Record(0.2, kFrameRate);
  const Channel channel = ChannelOf(grid, [](double t) { return std::sin(1000 * t); });
  const Block block = FitsOf(grid, channel, Frames(0, 21));
  EXPECT_EQ(block.samples(), 21);
  for (std::size_t i = 0; i < block.measured.size(); ++i)
    EXPECT_NEAR(block.measured[i], channel.values[i], 1e-12);
  EXPECT_NEAR(*block.sigma, 2, 1e-12);
}

// Interpolated values would count as measurements of their own.
TEST(PlateSamples, ARecordCoarserThanTheMotionIsReadWhereItHasSamples) {
  const Grid grid = Record(0.4, kFrameRate / 4);
  const Channel channel = ChannelOf(grid, [](double t) { return std::sin(20 * t); });
  const Block block = FitsOf(grid, channel, Frames(0, 41));
  EXPECT_THAT(block.sample, ElementsAre(0, 4, 8, 12, 16, 20, 24, 28, 32, 36, 40));
  for (std::size_t i = 0; i < block.measured.size(); ++i)
    EXPECT_NEAR(block.measured[i], channel.values[i], 1e-12);
}

TEST(PlateSamples, AtTheEndsALineIsFitted) {
  const Grid grid = Record(0.1);
  const Block block = FitsOf(grid, ChannelOf(grid, [](double t) { return 3 - 70 * t; }), Frames(-0.02, 15));
  EXPECT_THAT(block.sample, ElementsAre(2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12));
  for (std::size_t i = 0; i < block.measured.size(); ++i) {
    const double t = block.prediction_time[static_cast<std::size_t>(block.sample[i])];
    EXPECT_NEAR(block.measured[i], 3 - 70 * t, 1e-9) << t;
  }
}

TEST(PlateSamples, AFrameWithAGapIsLeftOut) {
  const Grid grid = Record(0.2);
  Channel channel = ChannelOf(grid, [](double t) { return 1 + t; });
  channel.values[101] = std::nan("");
  const Block block = FitsOf(grid, channel, Frames(0.05, 10));
  EXPECT_THAT(block.sample, ElementsAre(0, 1, 2, 3, 4, 6, 7, 8, 9));
  for (std::size_t i = 0; i < block.measured.size(); ++i)
    EXPECT_NEAR(block.measured[i], 1.05 + block.sample[i] / kFrameRate, 1e-9);
}

// Every other sample is nearly without load: it weighs next to nothing.
TEST(PlateSamples, TheForceWeighsTheCentreOfPressure) {
  Grid grid = Record(0.4);
  const auto odd = [](double t) { return std::lround(t * kPlateRate) % 2 != 0; };
  grid.channels["p_force_y"] = ChannelOf(grid, [&](double t) { return odd(t) ? 1e-6 : 300; });
  grid.channels["p_cop_x"] = ChannelOf(grid, [&](double t) { return odd(t) ? 9 : 2; });
  grid.channels["p_cop_x"].sigma.reset();
  Block block = Frames(0.05, 20);
  AddLocalFits(grid, grid.channels["p_cop_x"], "p", true, 0.1, kAnyLevel, block);
  ASSERT_EQ(block.samples(), 20);
  EXPECT_THAT(block.measured, Each(DoubleNear(2, 1e-6)));
  EXPECT_FALSE(block.sigma);
  // One sample later the values have changed places; the force, which weighs them, is not late.
  Vector change(20);
  Vector slopes(20);
  ASSERT_TRUE(block.later);
  block.later->At(1 / kPlateRate, change, slopes);
  EXPECT_NEAR(change[2], 7, 1e-6);
}

// Without load a plate computes any centre of pressure.
TEST(PlateSamples, ALightFootHasNoCentreOfPressure) {
  Grid grid = Record(0.3);
  grid.channels["p_force_y"] = ChannelOf(grid, [](double t) { return t < 0.1 ? -0.5 : 1e4 * (t - 0.1); });
  grid.channels["p_cop_x"] = ChannelOf(grid, [](double t) { return t < 0.1 ? 1e9 : 0.2 + t; });
  Block block = Frames(0.05, 20);
  AddLocalFits(grid, grid.channels["p_cop_x"], "p", true, 0.1, kAnyLevel, block);
  ASSERT_FALSE(block.sample.empty());
  EXPECT_EQ(block.sample.front(), 8) << "at 0.13 s, with 300 N of the largest 2000 N; at 0.12 s it is 200 N";
  for (std::size_t i = 0; i < block.measured.size(); ++i)
    EXPECT_NEAR(block.measured[i], 0.25 + block.sample[i] / kFrameRate, 1e-6);
}

}  // namespace
}  // namespace sinew
