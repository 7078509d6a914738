// Signals that jump away and back: dropouts, spikes, swapped markers.
#pragma once

#include <vector>

#include "datasets/check/finding.h"
#include "datasets/check/signals.h"

namespace sinew {

/// Stretches that begin and end with a jump, the second back to where the signal was. A jump is an increment,
/// less the median of its neighbours, that exceeds six times the 99th percentile of all others of the same
/// channel (of all trials), and a tenth of the channel's range; three times, if the stretch between is
/// constant. An input may jump in the first samples of a trial, when its controller is switched on.
[[nodiscard]] std::vector<Finding> FindExcursions(const ChannelGroup& group);

}  // namespace sinew
