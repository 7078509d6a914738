#include "problems/emg_shape/learning/clean_emg.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace sinew {
namespace {

constexpr double kFloor = 0.02;
constexpr double kNoise = 0.08;  // of the EMG
constexpr int kPerCycle = 40;
constexpr int kCycles = 6;

struct Recording {
  CycleSamples samples;
  std::vector<double> truth;
};

double Bell(double away, double width) {
  return std::exp(-0.5 * away * away / (width * width));
}

// One burst a cycle, larger and earlier in some recordings than in others, as its cycles are.
Recording Draw(double larger, double earlier, Random& random) {
  Recording recording;
  Vector mean(100);
  for (int i = 0; i < 100; ++i) mean[i] = kFloor + 0.5 * Bell(0.01 * i - 0.4 + earlier, 0.1);
  recording.samples.pattern = FindBursts(mean);
  for (int k = 0; k < kCycles; ++k) {
    const double gain = std::exp(larger + 0.2 * random.Normal());
    const double timing = earlier + 0.015 * random.Normal();
    for (int i = 0; i < kPerCycle; ++i) {
      const double phase = static_cast<double>(i) / kPerCycle;
      recording.truth.push_back(kFloor + gain * 0.5 * Bell(phase - 0.4 + timing, 0.1));
      recording.samples.phase.push_back(phase);
      recording.samples.values.push_back(recording.truth.back() * (1 + kNoise * random.Normal()));
      recording.samples.burst.push_back(recording.samples.pattern.BurstAt(k, phase));
    }
  }
  return recording;
}

// Root of the mean square of the relative errors.
double ErrorOf(const std::vector<std::vector<double>>& emg, const std::vector<Recording>& recordings) {
  double squares = 0;
  double count = 0;
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    EXPECT_EQ(emg[r].size(), recordings[r].truth.size());
    for (std::size_t i = 0; i < emg[r].size(); ++i) {
      squares += std::pow(emg[r][i] / recordings[r].truth[i] - 1, 2);
      count += 1;
    }
  }
  return std::sqrt(squares / count);
}

TEST(CleanEmg, IsNearerToTheTruthThanCurvesOfSingleRecordings) {
  Random random(5);
  std::vector<Recording> recordings;
  for (const double r : {-1.0, 0.0, 0.5, 1.0}) recordings.push_back(Draw(0.3 * r, 0.03 * r, random));
  std::vector<CycleSamples> samples;
  std::vector<std::vector<double>> measured;
  for (const Recording& recording : recordings) {
    samples.push_back(recording.samples);
    measured.push_back(recording.samples.values);
  }
  const auto scatter = EstimateCycleScatter(samples, 24, 1);
  ASSERT_TRUE(scatter) << scatter.error().message;
  const auto clean = CleanEmg(samples, std::vector<ShapeBasis>(4, ShapeBasis(14)), *scatter, 1);
  ASSERT_TRUE(clean) << clean.error().message;
  EXPECT_NEAR(ErrorOf(measured, recordings), kNoise, 0.1 * kNoise);
  EXPECT_LT(ErrorOf(*clean, recordings), 0.4 * kNoise);
  EXPECT_LT(ErrorOf(*clean, recordings), 0.6 * ErrorOf(scatter->emg, recordings));
}

// The filter of the envelope rounds fast cycles more than slow ones: it is one curve all the same.
TEST(CleanEmg, SeesTheCurveThroughEachRecordingsFilter) {
  Random random(6);
  std::vector<CycleSamples> samples;
  std::vector<ShapeBasis> basis;
  Vector curve = Vector::Zero(14);
  curve[5] = curve[6] = 1;
  for (const double harmonics : {3.0, 12.0}) {
    basis.emplace_back(14, harmonics);
    CycleSamples recording;
    for (int k = 0; k < kCycles; ++k) {
      for (int i = 0; i < kPerCycle; ++i) {
        const double phase = static_cast<double>(i) / kPerCycle;
        recording.phase.push_back(phase);
        recording.values.push_back((0.3 + basis.back().Value(phase, curve.data())) *
                                   (1 + 0.01 * random.Normal()));
        recording.burst.push_back(k);
      }
    }
    samples.push_back(std::move(recording));
  }
  const auto scatter = EstimateCycleScatter(samples, 24, 1);
  ASSERT_TRUE(scatter) << scatter.error().message;
  const auto clean = CleanEmg(samples, basis, *scatter, 1);
  ASSERT_TRUE(clean) << clean.error().message;
  for (std::size_t r = 0; r < 2; ++r) {
    for (std::size_t i = 0; i < samples[r].phase.size(); ++i) {
      const double truth = 0.3 + basis[r].Value(samples[r].phase[i], curve.data());
      EXPECT_NEAR((*clean)[r][i], truth, 0.02 * truth) << r << " at " << samples[r].phase[i];
    }
  }
}

}  // namespace
}  // namespace sinew
