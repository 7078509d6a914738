// Markers against the other markers of their segment, from which their distances hardly change.
#pragma once

#include <vector>

#include "datasets/check/finding.h"
#include "datasets/check/signals.h"

namespace sinew {

/// Faults of single markers (channels NAME_x, NAME_y, NAME_z in metres, at least six of them in a grid).
/// Which markers move together is found from the data: pairs whose distance has a robust deviation of at most
/// 6 mm.
///  - A marker that moves with no others, but does if one coordinate has the opposite sign, two are
///  exchanged, one is 1000 times smaller or larger, or all three are shifted in time: sign, axis, unit, lag.
///  Where distances are constant anyway, because a coordinate hardly changes, those on the other side of the
///  body tell (names with a side).
///  - Times at which at least half of a marker's distances, and two of them, are wrong by 3 cm, by eight
///  robust deviations, and by four times what 85 % of the frames stay below: displaced, or a spike.
/// Nothing, if fewer than 60 % of the markers have two others that they move with.
[[nodiscard]] std::vector<Finding> FindBrokenSegments(const std::vector<ChannelGroup>& groups);

}  // namespace sinew
