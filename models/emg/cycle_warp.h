// Time normalisation: the same number of samples for every cycle, and the mean of many. SCIENCE section 5.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/error.h"

namespace sinew {

/// The thesis's (eq 6.1): sample k lies at the share k / (K - 1) of the cycle, its beginning and end
/// included.
constexpr std::size_t kWarpSamples = 2000;

/// emg(t) -> emg(k): values by straight lines between samples.
/// @param time [N, s, increasing] @param values [N, any unit] @param begin_s @param end_s [s] a cycle
/// @param samples K [2..] @return [K]. Errors: sizes; a cycle that ends before it begins or that the samples
/// do not cover; a value in it that is not finite. O(log N + samples in the cycle + K).
Result<std::vector<double>> WarpCycle(const std::vector<double>& time, const std::vector<double>& values,
                                      double begin_s, double end_s, std::size_t samples = kWarpSamples);

/// emg(k) -> emg at a share of the cycle, on straight lines between samples.
/// @param curve [K >= 2] @param phase [0..1]; outside it the nearest end's value
[[nodiscard]] double AtPhase(const std::vector<double>& curve, double phase);

/// A cycle of this duration in time: samples at 0, 1 / rate, ... up to the duration.
/// @param curve [K >= 2] @param duration_s [s, > 0] @param rate_Hz [Hz, > 0]
[[nodiscard]] std::vector<double> UnwarpCycle(const std::vector<double>& curve, double duration_s,
                                              double rate_Hz);

struct MeanCurve {
  std::size_t cycles = 0;
  std::vector<double> mean;       ///< [K]
  std::vector<double> deviation;  ///< standard deviation over the cycles, n - 1 [K]; empty for one cycle
};

/// @param cycles [n >= 1][K], std::invalid_argument if they are none or differ in length. O(n K).
[[nodiscard]] MeanCurve MeanOfCycles(const std::vector<std::vector<double>>& cycles);

}  // namespace sinew
