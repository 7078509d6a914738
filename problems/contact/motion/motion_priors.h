// What deviations of the pose each stance of a data set may have.
#pragma once

#include <string>
#include <vector>

#include "problems/contact/motion/motion_errors.h"
#include "problems/contact/stance.h"

namespace sinew {

/// Gives every stance its deviations: curves over the phase of the stance in the frame of the foot, which all
/// stances have in common (mirrored for the other foot), and curves in time of its own. Their standard
/// deviations are those that are set, or else what the markers on the feet say, or else published ones.
/// @param next_parameter index of the two parameters of the prior, advanced past them, the common weights and
/// the own ones of each stance in turn
/// @param notes one sentence on the prior
void AddMotionErrors(const MotionErrorSettings& settings, std::vector<Stance>& stances, int& next_parameter,
                     std::vector<std::string>& notes);

}  // namespace sinew
