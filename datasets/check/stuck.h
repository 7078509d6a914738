// Sensors that repeat one value.
#pragma once

#include <vector>

#include "datasets/check/finding.h"
#include "datasets/check/signals.h"

namespace sinew {

/// Runs of equal values in a channel that otherwise does not repeat itself, and runs of any channel after
/// which it jumps to where it would have been. Values that a channel rests at again and again (no contact),
/// motion in straight lines (trapezoids), held inputs and rests of a rounded sensor do not count.
[[nodiscard]] std::vector<Finding> FindStuck(const ChannelGroup& group);

}  // namespace sinew
