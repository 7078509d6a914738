#include "problems/emg_shape/learning/cycle_scatter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace sinew {
namespace {

constexpr double kScatterFloor = 0.02;
constexpr double kScatterNoise = 0.08;  // of the EMG
constexpr int kScatterPerCycle = 40;

// How the cycles of a recording scatter.
struct Truth {
  double gain = 0.2;
  double timing = 0.015;
  bool together = true;  // both bursts of a cycle
  int cycles = 40;
  double fatigue = 0;  // growth of the logarithm of the gain per cycle
};

double BellCurve(double away, double width) {
  return std::exp(-0.5 * away * away / (width * width));
}

// Two bursts a cycle, the later one small, and errors that grow with the EMG.
CycleSamples Draw(const Truth& truth, Random& random) {
  CycleSamples samples;
  Vector mean(100);
  for (int i = 0; i < 100; ++i)
    mean[i] = kScatterFloor + 0.5 * BellCurve(0.01 * i - 0.3, 0.07) + 0.1 * BellCurve(0.01 * i - 0.75, 0.06);
  samples.pattern = FindBursts(mean);
  EXPECT_EQ(samples.pattern.count(), 2);
  for (int k = 0; k < truth.cycles; ++k) {
    std::array<double, 2> gain{};
    std::array<double, 2> timing{};
    for (const std::size_t b : {0U, 1U}) {
      gain[b] = std::exp(truth.gain * random.Normal() + truth.fatigue * (k - 0.5 * (truth.cycles - 1)));
      timing[b] = truth.timing * random.Normal();
    }
    if (truth.together) {
      gain[1] = gain[0];
      timing[1] = timing[0];
    }
    for (int i = 0; i < kScatterPerCycle; ++i) {
      const double phase = static_cast<double>(i) / kScatterPerCycle;
      const double emg = kScatterFloor + gain[0] * 0.5 * BellCurve(phase - 0.3 + timing[0], 0.07) +
                         gain[1] * 0.1 * BellCurve(phase - 0.75 + timing[1], 0.06);
      samples.phase.push_back(phase);
      samples.values.push_back(emg * (1 + kScatterNoise * random.Normal()));
      samples.burst.push_back(samples.pattern.BurstAt(k, phase));
    }
  }
  return samples;
}

CycleScatter Estimate(const std::vector<CycleSamples>& recordings) {
  auto scatter = EstimateCycleScatter(recordings, 24, 1);
  EXPECT_TRUE(scatter) << scatter.error().message;
  return *scatter;
}

TEST(CycleScatter, BurstsOfACycleVaryTogetherOrNot) {
  Random random(1);
  const CycleScatter together = Estimate({Draw({}, random), Draw({}, random)});
  EXPECT_NEAR(together.gain.total, 0.2, 0.03);
  EXPECT_NEAR(together.timing.total, 0.015, 0.003);
  EXPECT_EQ(together.gain.own(), 0);
  EXPECT_EQ(together.timing.own(), 0);
  EXPECT_EQ(together.after, 1) << "the later burst belongs to the main one before it";
  Truth apart;
  apart.together = false;
  const CycleScatter own = Estimate({Draw(apart, random), Draw(apart, random)});
  EXPECT_NEAR(own.gain.total, 0.2, 0.03);
  EXPECT_GT(own.gain.own(), 0.17);
  EXPECT_GT(own.timing.own(), 0.011);
}

TEST(CycleScatter, NoiseIsWhatGainsAndTimingsDoNotExplain) {
  Random random(2);
  const CycleScatter scatter = Estimate({Draw({}, random), Draw({}, random)});
  EXPECT_NEAR(scatter.modulated.growth, kScatterNoise, 0.15 * kScatterNoise);
  EXPECT_LT(scatter.modulated.quiet, 0.5 * kScatterNoise * kScatterFloor);
}

TEST(CycleScatter, ARecordingOfAnotherKindIsToldByItsOwn) {
  Random random(3);
  Truth wild;
  wild.timing = 0.06;
  wild.cycles = 12;
  Truth usual;
  usual.cycles = 12;
  const CycleScatter scatter =
      Estimate({Draw(usual, random), Draw(wild, random), Draw(usual, random), Draw(usual, random)});
  // A regression on the slope tells large shifts as too small.
  EXPECT_GT(scatter.timing.factor[1], 1.5);
  EXPECT_LT(scatter.timing.total, 0.025);
  for (const std::size_t r : {0U, 2U, 3U}) EXPECT_NEAR(scatter.timing.factor[r], 0.9, 0.3) << r;
}

// Of 24 cycles; their trend has a standard deviation of 0.26.
TEST(CycleScatter, ATrendFromCycleToCycleIsNone) {
  Random random(5);
  Truth tired;
  tired.cycles = 6;
  tired.gain = 0.15;
  tired.fatigue = -0.15;
  double without = 0;
  double with = 0;
  constexpr int kDraws = 50;
  for (int i = 0; i < kDraws; ++i) {
    std::vector<CycleSamples> recordings;
    for (int r = 0; r < 4; ++r) recordings.push_back(Draw(tired, random));
    with += std::pow(Estimate(recordings).gain.total, 2) / kDraws;
    Truth rested = tired;
    rested.fatigue = 0;
    recordings.clear();
    for (int r = 0; r < 4; ++r) recordings.push_back(Draw(rested, random));
    without += std::pow(Estimate(recordings).gain.total, 2) / kDraws;
  }
  // The standard error of either is 2.5 %; single bursts with errors of 8 % tell 0.14.
  EXPECT_NEAR(std::sqrt(without), 0.14, 0.015);
  EXPECT_NEAR(std::sqrt(with), std::sqrt(without), 0.02);
}

TEST(CycleScatter, ARecordingThatRepeatsItselfHasTheLeast) {
  Random random(4);
  Truth same;
  same.gain = same.timing = 0;
  const CycleScatter scatter = Estimate({Draw(same, random)});
  EXPECT_LT(scatter.gain.total, 0.03);
  EXPECT_LT(scatter.timing.total, 0.003);
  EXPECT_FALSE(EstimateCycleScatter({}, 14, 1));
}

TEST(SharedTiming, IsWhatMusclesHaveInCommon) {
  // Both early and late together by 0.03, each by 0.01 of its own, with and against.
  const std::vector<std::vector<CycleTiming>> together{
      {{0, 0, 0.04}, {0, 1, 0.02}, {1, 0, -0.04}, {1, 1, -0.02}},
      {{0, 0, 0.02}, {0, 1, 0.04}, {1, 0, -0.04}, {1, 1, -0.02}}};
  EXPECT_NEAR(SharedTiming(together), std::sqrt((0.0008 + 0.0008 + 0.0016 + 0.0004) / 4), 1e-12);
  EXPECT_EQ(SharedTiming({{{0, 0, 0.03}, {0, 1, -0.03}}, {{0, 0, -0.03}, {0, 1, 0.03}}}), 0) << "against";
  EXPECT_EQ(SharedTiming({{{0, 0, 0.03}}}), 0) << "one muscle";
}

}  // namespace
}  // namespace sinew
