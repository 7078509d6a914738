// How much the cycles of one movement differ from each other, before anything is fitted.
#pragma once

#include <vector>

#include "base/error.h"
#include "base/linear_algebra.h"

namespace sinew {

/// Samples of one muscle in one recording.
struct CycleSamples {
  std::vector<double> phase;   ///< [N, cycles]
  std::vector<double> values;  ///< [N]
  std::vector<int> burst;      ///< [N] which burst each is of, not decreasing
  std::vector<int> cycle;      ///< [N] of the movement, in which each lies
  int bursts = 1;              ///< per cycle
};

// Least scatter: of a movement that repeats itself exactly nothing would be left to learn a prior from.
constexpr double kLeastGainScatter = 0.01;
constexpr double kLeastTimingScatter = 0.001;  // [cycle]

/// When one burst came.
struct BurstTiming {
  int recording = 0;
  int cycle = 0;      ///< of the movement, in which its middle lies
  double timing = 0;  ///< early by this [cycle]
};

struct CycleScatter {
  double gain = 0;    ///< standard deviation of a burst's log gain about its recording's mean
  double timing = 0;  ///< and of its timing [cycle]
  double noise = 0;   ///< standard deviation of what gain and timing do not explain
  /// Where it comes from: noise^2 = quiet^2 + growth^2 EMG^2, its mean over all samples.
  double quiet = 0;
  double growth = 0;
  std::vector<BurstTiming> timings;
};

/// By moments: a shape per recording by least squares, a gain and a timing per burst by regression on it and
/// on its slope, their mean squares less what noise alone would make of them. Noise counts as correlated over
/// `correlated` samples.
/// @param recordings each with two cycles or more @param knots of a shape
/// @return Errors: those of FitShape; no recording.
Result<CycleScatter> EstimateCycleScatter(const std::vector<CycleSamples>& recordings, int knots,
                                          double correlated);

/// Standard deviation of the timing that bursts of different muscles in one cycle have in common, by their
/// mean product; 0 if it is negative, or there is one muscle. @param muscles [M] timings of each
[[nodiscard]] double SharedTiming(const std::vector<std::vector<BurstTiming>>& muscles);

}  // namespace sinew
