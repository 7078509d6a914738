// Numbers that cannot be in the unit, of the sign or along the axis that their names say.
#pragma once

#include <vector>

#include "datasets/check/finding.h"
#include "datasets/check/signals.h"
#include "datasets/dataset.h"

namespace sinew {

/// Channels with a unit whose range, or level if it stays away from 0, in one trial is 57.3 (of angles) or
/// 1000 times that of the others, or the inverse, and further from the nearest of them than they are from
/// each other; and channels that are negative in one trial and positive in all others, or the inverse.
[[nodiscard]] std::vector<Finding> FindOddScales(const ChannelGroup& group);

/// What is known of the quantities themselves:
///  - plates: the ground pushes upwards, more than sideways, and with 0.03 to 30 times the body weight
///  (constant
///    body_mass); the centre of pressure lies where the markers are;
///  - a speed is the derivative of the position of its grid: sign, unit and time;
///  - activities of muscles are positive;
///  - a joint turns by less than four revolutions; the ranges of right and left are not 57.3 or 1000 times
///  apart.
[[nodiscard]] std::vector<Finding> FindImplausible(const Dataset& dataset,
                                                   const std::vector<ChannelGroup>& groups);

}  // namespace sinew
