// The noise of a measured channel from its differences.
#include "identify/noise/difference_noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/constants.h"
#include "base/random.h"
#include "tests/identify/support/toy_problem.h"

namespace sinew::noise {
namespace {

constexpr double kNoise = 0.01;
constexpr double kDuration = 10;  // [s]

Block Sampled(double rate, const std::function<double(double)>& of) {
  Block block = toy::MakeBlock("trial", "angle", static_cast<int>(kDuration * rate) + 1, kDuration);
  for (std::size_t i = 0; i < block.measured.size(); ++i) block.measured[i] = of(block.prediction_time[i]);
  return block;
}

// A sine of 1 Hz and of deviation 1 with noise.
Block Sine(double rate, double noise, std::uint64_t seed = 1) {
  Random random(seed);
  return Sampled(rate,
                 [&](double t) { return std::sqrt(2.0) * std::sin(6.28 * t) + noise * random.Normal(); });
}

void Round(double step, Block& block) {
  for (double& value : block.measured) value = step * std::round(value / step);
}

TEST(DifferenceNoise, OfAMovingSignalIsThatOfTheNoiseAtAnyRate) {
  for (const double rate : {50.0, 100.0, 1000.0}) {
    const auto found = DifferenceNoise(Sine(rate, kNoise));
    ASSERT_TRUE(found);
    EXPECT_TRUE(found->visible) << rate;
    EXPECT_NEAR(found->deviation, kNoise, 0.15 * kNoise) << rate;
  }
}

TEST(DifferenceNoise, IsVisibleDecadesBelowTheSignal) {
  for (const double rate : {100.0, 250.0, 1000.0}) {
    for (const double noise : {1e-3, 1e-4, 1e-5}) {
      const auto found = DifferenceNoise(Sine(rate, noise));
      EXPECT_TRUE(found->visible) << rate << " Hz, " << noise;
      EXPECT_NEAR(found->deviation, noise, 0.15 * noise) << rate << " Hz, " << noise;
    }
  }
}

TEST(DifferenceNoise, OfOneTrialIsThatOfItsParts) {
  const Block whole = Sine(1000, 1e-4);
  for (const std::size_t parts : {2, 8}) {
    Block part = toy::MakeBlock("trial", "angle", static_cast<int>(whole.measured.size() / parts), 1);
    part.measured.assign(whole.measured.begin(),
                         whole.measured.begin() + static_cast<std::ptrdiff_t>(part.measured.size()));
    EXPECT_TRUE(DifferenceNoise(part)->visible);
    EXPECT_NEAR(DifferenceNoise(part)->deviation, 1e-4, 0.15e-4) << parts;
  }
}

// An axis with dry friction: its acceleration jumps at reversals, where it also rests.
TEST(DifferenceNoise, IsNotHiddenByKinksOfDryFriction) {
  for (const double rate : {100.0, 1000.0}) {
    Random random(3);
    const auto found = DifferenceNoise(Sampled(rate, [&](double t) {
      const double turn = t - std::floor(t);
      const double moved = turn < 0.4 ? 6.25 * turn * turn : turn < 0.6 ? 1 : 6.25 * (1 - turn) * (1 - turn);
      return 0.2 * moved + 5e-6 * random.Normal();
    }));
    EXPECT_TRUE(found->visible) << rate;
    EXPECT_NEAR(found->deviation, 5e-6, 1e-6) << rate;
  }
}

TEST(DifferenceNoise, OfCorrelatedNoiseIsALowerLimit) {
  Random random(4);
  const double root = 0.9;
  double noise = 0;
  const auto found = DifferenceNoise(Sampled(1000, [&](double t) {
    noise = root * noise + 1e-4 * random.Normal();
    return std::sin(6.28 * t) + noise;
  }));
  EXPECT_TRUE(found->visible);
  EXPECT_NEAR(found->deviation, 1e-4 / (1 + root), 0.1e-4);  // the spectrum at the highest frequency
}

TEST(DifferenceNoise, IsNotRaisedByJumps) {
  Block block = Sine(100, kNoise);
  for (std::size_t i = 50; i < block.measured.size(); i += 100) block.measured[i] += 5;
  EXPECT_TRUE(DifferenceNoise(block)->visible);
  EXPECT_NEAR(DifferenceNoise(block)->deviation, kNoise, 0.2 * kNoise);
}

TEST(DifferenceNoise, IsNoLessThanTheRounding) {
  for (const double step : {1e-2, 1e-4, 1e-5}) {
    Block block = Sine(1000, 0);
    Round(step, block);
    EXPECT_TRUE(DifferenceNoise(block)->visible) << step;
    EXPECT_GE(DifferenceNoise(block)->deviation, step / std::sqrt(12.0) * (1 - 1e-9)) << step;
    EXPECT_LE(DifferenceNoise(block)->deviation, step) << step;
  }
}

TEST(DifferenceNoise, BesideRoundingIsTheSumOfBoth) {
  Block block = Sine(1000, 1e-4);
  Round(1e-4, block);
  EXPECT_TRUE(DifferenceNoise(block)->visible);
  EXPECT_NEAR(DifferenceNoise(block)->deviation, 1e-4 * std::sqrt(1 + 1 / 12.0), 0.15e-4);
}

TEST(DifferenceNoise, IsUnknownOfFewSamplesAndOfCorrelatedNoise) {
  EXPECT_FALSE(DifferenceNoise(toy::MakeBlock("trial", "angle", 20, 1)));
  Block envelope = Sine(100, kNoise);
  envelope.noise_memory = 0.1;
  EXPECT_FALSE(DifferenceNoise(envelope));
}

TEST(DifferenceNoise, IsNotVisibleInASignalWithoutNoise) {
  for (const double rate : {50.0, 100.0, 1000.0}) EXPECT_FALSE(DifferenceNoise(Sine(rate, 0))->visible);
  // Stored with seven digits.
  Block stored = Sine(1000, 0);
  for (double& value : stored.measured) value = static_cast<float>(value);
  EXPECT_FALSE(DifferenceNoise(stored)->visible);
}

TEST(DifferenceNoise, IsNotVisibleAfterAFilterOrAnInterpolation) {
  const Block noisy = Sine(1000, kNoise);
  Block held = noisy;
  Block straight = noisy;
  constexpr std::size_t kEvery = 10;
  for (std::size_t i = 0; i < noisy.measured.size(); ++i) {
    const std::size_t before = i - i % kEvery;
    const std::size_t after = std::min(before + kEvery, noisy.measured.size() - 1);
    const double share = static_cast<double>(i - before) / kEvery;
    held.measured[i] = noisy.measured[before];
    straight.measured[i] = (1 - share) * noisy.measured[before] + share * noisy.measured[after];
  }
  EXPECT_FALSE(DifferenceNoise(held)->visible);
  EXPECT_FALSE(DifferenceNoise(straight)->visible);
  // First-order low-pass of 5 Hz, twice forwards and twice backwards.
  Block filtered = noisy;
  const double keep = std::exp(-2 * kPi * 5 / 1000);
  for (int pass = 0; pass < 4; ++pass) {
    double state = filtered.measured.front();
    for (double& value : filtered.measured) value = state = keep * state + (1 - keep) * value;
    std::reverse(filtered.measured.begin(), filtered.measured.end());
  }
  EXPECT_FALSE(DifferenceNoise(filtered)->visible);
}

}  // namespace
}  // namespace sinew::noise
