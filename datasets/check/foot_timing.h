// Plates against the markers of the feet that stand on them: one clock?
#pragma once

#include <vector>

#include "datasets/check/finding.h"
#include "datasets/check/signals.h"
#include "datasets/dataset.h"

namespace sinew {

/// Plates that are loaded earlier or later than the foot on them stands still. A marker near the floor stands
/// while it moves by less than 0.5 m/s against the floor, whose speed (a treadmill's belt) is that of such
/// markers when they are lowest. The markers that stand in the middle of a contact, near its centre of
/// pressure, tell when the foot does. A foot comes to rest after it touches and moves before it leaves, so
/// that the mean of the two differences is the delay: found, if it exceeds 0.05 s and three quarters of what
/// the differences scatter.
[[nodiscard]] std::vector<Finding> FindLatePlates(const Dataset& dataset,
                                                  const std::vector<ChannelGroup>& groups);

}  // namespace sinew
