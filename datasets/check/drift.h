// Levels at rest that change during a recording.
#pragma once

#include <vector>

#include "datasets/check/cycles.h"
#include "datasets/check/finding.h"
#include "datasets/check/signals.h"

namespace sinew {

/// A force, torque or voltage whose level at rest rises or falls steadily. At rest: of a cyclic trial, the
/// quarter of the cycle at which the channel scatters least from cycle to cycle; of a plate, the times at
/// which it is unloaded. The slope is the median of all slopes between two such levels (Theil and Sen); it
/// counts if more than 5 % of the channel's range are gained, four times the scatter of the levels about it,
/// and Kendall's test of order exceeds four standard deviations.
[[nodiscard]] std::vector<Finding> FindDrift(const Signal& signal, const Cycles& cycles);

}  // namespace sinew
