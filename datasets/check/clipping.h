// Signals that are cut off at the end of a sensor's range.
#pragma once

#include <vector>

#include "datasets/check/finding.h"
#include "datasets/check/signals.h"

namespace sinew {

/// Runs of one and the same value, at least three samples each, that the signal reaches and leaves on the
/// same side with a slope: a smooth peak has none there. 0 (no contact, a rectified signal), motion in
/// straight lines and inputs that are cut off on both sides (the limit of an actuator) do not count.
[[nodiscard]] std::vector<Finding> FindClipping(const ChannelGroup& group);

}  // namespace sinew
