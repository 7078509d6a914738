// In which direction a body walks, which is not where its foot points.
#pragma once

#include "models/multibody/coordinate_trajectory.h"
#include "models/multibody/multibody_model.h"
#include "problems/contact/settings.h"
#include "problems/contact/stance.h"

namespace sinew {

/// Sets Stance::progression to the horizontal direction in which the first body between ground and the foot
/// (the pelvis) moves over the floor while the foot is loaded. Where it moves by less than half of the sole's
/// length, or in another direction than the foot points by more than 45 degrees, it is Stance::forward.
/// @param root that first body
/// Errors: those of MultibodyModel::BodyMotions.
Status FindProgression(const CoordinateTrajectory& motion, const MultibodyModel& model, int root,
                       const Floor& floor, Stance& stance);

}  // namespace sinew
