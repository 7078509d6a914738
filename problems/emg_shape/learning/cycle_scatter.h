// How much the cycles of one movement differ from each other, before anything is fitted.
#pragma once

#include <vector>

#include "base/error.h"
#include "base/linear_algebra.h"
#include "problems/emg_shape/learning/bursts.h"
#include "problems/emg_shape/learning/modulated_noise.h"

namespace sinew {

/// Samples of one muscle in one recording.
struct CycleSamples {
  std::vector<double> phase;   ///< [N, cycles]
  std::vector<double> values;  ///< [N]
  std::vector<int> burst;      ///< [N] BurstPattern::BurstAt, not decreasing
  BurstPattern pattern;        ///< its `after` is found out
};

// Least scatter: a movement that repeats itself exactly would give a prior of zero width.
constexpr double kMinGainScatter = 0.01;
constexpr double kMinTimingScatter = 0.001;  // [cycle]

/// How single bursts differ from the mean of their recording: standard deviations.
struct Scatter {
  double total = 0;     ///< of a burst
  double together = 0;  ///< of what the bursts of one cycle have in common; all of it where there is but one
  std::vector<double> factor;  ///< [recordings] by which both are larger, or smaller, in one

  /// Of what each burst has of its own.
  [[nodiscard]] double own() const;
};

/// When a cycle's bursts came.
struct CycleTiming {
  int recording = 0;
  int cycle = 0;      ///< BurstPattern::CycleOf
  double timing = 0;  ///< early by this, mean of its bursts, over their recording's factor [cycle]
};

struct CycleScatter {
  Scatter gain;      ///< of the logarithm
  Scatter timing;    ///< [cycle]
  int after = 0;     ///< BurstPattern::after
  double noise = 0;  ///< root of the mean square of what gain and timing do not explain
  ModulatedNoise modulated;
  /// [recordings][N] what is there without noise, at the gain and timing of its burst: what the noise grows
  /// with
  std::vector<std::vector<double>> emg;
  std::vector<CycleTiming> timings;
};

/// By moments: a shape per recording by least squares, a gain and a timing per burst by regression on it and
/// on its slope, their mean squares less what noise alone would make of them; mean products of the bursts of
/// a cycle for what they have in common. Which neighbours that are is what brings the largest products. Noise
/// counts as correlated over `correlated` samples.
/// @param recordings each with two cycles or more @param knots of a shape
/// @return Errors: those of FitShape; no recording.
Result<CycleScatter> EstimateCycleScatter(const std::vector<CycleSamples>& recordings, int knots,
                                          double correlated);

/// Standard deviation of the timing that bursts of different muscles in one cycle have in common, by their
/// mean product; 0 if it is negative, or there is one muscle. @param muscles [M] timings of each
[[nodiscard]] double SharedTiming(const std::vector<std::vector<CycleTiming>>& muscles);

}  // namespace sinew
