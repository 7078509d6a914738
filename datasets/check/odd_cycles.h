// Cycles, steps and short trials unlike the others of their kind.
#pragma once

#include <vector>

#include "datasets/check/cycles.h"
#include "datasets/check/finding.h"
#include "datasets/check/signals.h"

namespace sinew {

/// Cycles of a channel that deviate from the median cycle far more than the cycles usually do: in the
/// logarithm of the RMS deviation by more than five robust standard deviations, and by a factor of two.
/// Medians hold while fewer than half of the cycles are spoilt, wherever they are.
[[nodiscard]] std::vector<Finding> FindOddCycles(const Signal& signal, const Cycles& cycles);

/// The same for trials that are one movement each, such as stances cut out of a recording: at least eight of
/// alike duration, compared along their normalised time.
[[nodiscard]] std::vector<Finding> FindOddTrials(const ChannelGroup& group);

}  // namespace sinew
