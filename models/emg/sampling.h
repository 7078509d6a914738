// Sampling rate of a recorded signal, and resampling to a lower one.
#pragma once

#include <vector>

#include "base/error.h"

namespace sinew {

/// The sampling rate of a uniformly sampled signal: samples per second from the first to the last.
/// @param time [N >= 2, s, strictly increasing] @return [Hz]. Errors: fewer than two samples; a step of less
/// than half or more than one and a half of the median step: samples are missing, or were taken at another
/// rate (the message states the time). Filters are not valid there.
Result<double> UniformRate(const std::vector<double>& time);

struct SampledSignal {
  std::vector<double> time;    ///< [N, s]
  std::vector<double> values;  ///< [N]
};

/// The samples of a signal at a lower rate: times first, first + 1 / rate, ... on the same clock, values by
/// straight lines between neighbours, so that none lies above or below the signal's own. A signal without
/// content above f keeps its values to (2 pi f / old rate)^2 / 8: 4e-5 for an envelope of 6 Hz at 2048 Hz.
///
/// @param time [N >= 1, s, strictly increasing] @param values [N] @param rate_Hz of the result [Hz, > 0]
[[nodiscard]] SampledSignal SampleAtRate(const std::vector<double>& time, const std::vector<double>& values,
                                         double rate_Hz);

}  // namespace sinew
