// Faults of a raw EMG signal, found before it is filtered.
#pragma once

#include <cstddef>
#include <vector>

namespace sinew {

/// A run of neighbouring samples.
struct SampleRun {
  std::size_t first = 0;
  std::size_t count = 0;
};

struct RawEmgFaults {
  /// The signal never changes, or has no finite sample: a loose electrode. The other faults are then not
  /// looked for, except gaps.
  bool silent = false;
  std::vector<SampleRun> gaps;     ///< samples that are not finite
  std::vector<SampleRun> clipped;  ///< at the largest or smallest value for 1 ms and three samples or more
  std::vector<SampleRun> frozen;   ///< at one value elsewhere for 20 ms or more: the transmission dropped out
};

/// A signal of fewer than 64 quantisation steps is often constant without a fault: it is not reported as
/// clipped.
/// @param raw [N, any unit] @param rate_Hz [Hz, > 0]
[[nodiscard]] RawEmgFaults FindRawEmgFaults(const std::vector<double>& raw, double rate_Hz);

[[nodiscard]] std::size_t TotalSamples(const std::vector<SampleRun>& runs);

/// The longest run; the first of them. @param runs not empty
[[nodiscard]] const SampleRun& LongestRun(const std::vector<SampleRun>& runs);

}  // namespace sinew
