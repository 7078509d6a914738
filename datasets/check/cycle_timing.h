// Channels and devices whose place in the cycle differs between trials.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "datasets/check/cycles.h"
#include "datasets/check/finding.h"
#include "datasets/check/signals.h"

namespace sinew {

/// Grids (devices), and single channels, that are later or earlier in the cycle than the others of their
/// trial, as compared to other trials whose cycles last as long within 15 %. The median cycle of each channel
/// is shifted to where it resembles that of the other trial best; the median shift of a grid is that of its
/// device, and the median of all grids that of where the cycles begin. Found, if a shift differs from the
/// others by more than 0.06 s and 7 % of the cycle, and four times what the shifts of its grid scatter; of a
/// single channel, if the shift also explains 70 % of what differs. With several other trials two of them
/// must agree; two trials that disagree are named together.
/// @param cycles,signals of each trial
[[nodiscard]] std::vector<Finding> FindLateInCycles(
    const std::map<std::string, Cycles>& cycles,
    const std::map<std::string, std::vector<const Signal*>>& signals);

}  // namespace sinew
