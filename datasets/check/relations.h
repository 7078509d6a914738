// Relations between the channels of a trial that hold in the other trials: sign, unit, time.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "datasets/check/finding.h"
#include "datasets/check/signals.h"

namespace sinew {

/// Channels of a trial that have another sign, another unit (57.3 or 1000 times as large) or another time
/// than the other trials say. Each channel is predicted by a linear relation with other channels of its
/// trial, their first and second derivatives (so that inertia, damping and stiffness are in it), fitted to
/// the other trials. A prediction that correlates with the opposite of the measurement, is off by the factor
/// of a unit, or fits better at another time, tells. Channels that others do not predict say nothing. The
/// channel that explains most is corrected and the search repeated, so that one fault is one finding.
[[nodiscard]] std::vector<Finding> FindBrokenRelations(const std::vector<ChannelGroup>& groups);

}  // namespace sinew
