// Inputs that repeat one shape in several trials: the same command, the same protocol.
#pragma once

#include <vector>

#include "datasets/check/finding.h"
#include "datasets/check/signals.h"

namespace sinew {

/// Trials of one duration whose input is, but for size and offset, the same as in two others: late, or
/// unlike them in a stretch. Size and offset are those of the 70 % of the samples that fit best, so that a
/// stretch does not move them. Shapes are the same if the median deviation is below 0.3 % of the range, as
/// that of commands is. What is measured never repeats itself like this.
[[nodiscard]] std::vector<Finding> FindOddRepeats(const ChannelGroup& group);

}  // namespace sinew
