// Stretches that are displaced in signals which change about as much from one sample to the next as such a
// stretch does: an autoregression predicts the usual changes, and the jumps remain.
#pragma once

#include <vector>

#include "datasets/check/finding.h"
#include "datasets/check/signals.h"

namespace sinew {

/// kDisplaced. Only of channels with few samples per oscillation, whose increments tell nothing
/// (FindExcursions is for all others), with at least 100 samples.
[[nodiscard]] std::vector<Finding> FindDisplacedStretches(const ChannelGroup& group);

}  // namespace sinew
