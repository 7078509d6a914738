// What deviations of the pose each stance of a data set may have.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "problems/contact/motion/motion_errors.h"
#include "problems/contact/stance.h"

namespace sinew {

/// Gives every stance its deviations: curves over the phase of the stance in the frame of the foot, which all
/// stances have in common (mirrored for the other foot), and curves in time of its own. Their standard
/// deviations are those that are set, or else what the markers on the feet say, or else published ones. A
/// floor that moves has a velocity that is known to some accuracy. Curves of a stance of its own have,
/// besides, what the noise of its markers leaves in the pose.
/// @param floor_error standard deviation of its velocity along x and z [m/s]; 0: known exactly
/// @param next_parameter index of the first parameter of the prior, advanced past all of them, the common
/// weights, the floor's velocities and the own weights of each stance in turn
/// @param notes one sentence on the prior
void AddMotionErrors(const MotionErrorSettings& settings, const std::array<double, 2>& floor_error,
                     std::vector<Stance>& stances, int& next_parameter, std::vector<std::string>& notes);

}  // namespace sinew
