// Numbers that cannot be in the unit, of the sign or along the axis that their names say.
#pragma once

#include <vector>

#include "datasets/check/finding.h"
#include "datasets/check/signals.h"
#include "datasets/dataset.h"

namespace sinew {

/// Channels whose range in one trial is 57.3 or 1000 times (within a factor of 2.5) that of the others, or
/// the inverse, where the others agree within a factor of four.
[[nodiscard]] std::vector<Finding> FindOddScales(const ChannelGroup& group);

/// What is known of the quantities themselves:
///  - plates: the ground pushes upwards, more than sideways, and with 0.03 to 30 times the body weight
///  (constant
///    body_mass); the centre of pressure lies where the markers are;
///  - a speed is the derivative of the position of its grid: sign, unit and time;
///  - a joint turns by less than four revolutions; the ranges of right and left are not 57.3 or 1000 times
///  apart.
[[nodiscard]] std::vector<Finding> FindImplausible(const Dataset& dataset,
                                                   const std::vector<ChannelGroup>& groups);

}  // namespace sinew
