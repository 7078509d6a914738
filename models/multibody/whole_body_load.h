// What the ground has to do so that a whole body moves as recorded: Newton's and Euler's laws of all bodies
// together, in which no muscle and no joint appears.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "models/multibody/coordinate_trajectory.h"
#include "models/multibody/multibody_model.h"

namespace sinew {

/// The sum of all forces from outside but gravity, in ground axes.
struct WholeBodyLoad {
  Vec3 force = Vec3::Zero();        ///< [N]
  Vec3 moment = Vec3::Zero();       ///< about the origin of ground [N m]
  Vec3 mass_centre = Vec3::Zero();  ///< [m]
};

/// Rate of change of linear and angular momentum, less gravity: sum over the bodies of m (a - g) and of
/// c x m (a - g) + d(I w)/dt, with the acceleration a of the mass centre c (Winter 2009, Biomechanics and
/// Motor Control of Human Movement, ch. 5). Mass properties are those that the model was built with.
/// @param times [N, s] @param gravity [m/s2, ground axes]
/// Errors: those of MultibodyModel::BodyMotions; a model whose bodies have no mass.
Result<std::vector<WholeBodyLoad>> WholeBodyLoads(const MultibodyModel& model, const Vec3& gravity,
                                                  const std::vector<double>& times,
                                                  const CoordinateTrajectory& motion);

/// Share of the body's mass that a coordinate moves at the default pose [0..1]. Errors: those of
/// MultibodyModel::BodyMotionAt and CoordinateIndex.
Result<double> MassMovedBy(const MultibodyModel& model, const std::string& coordinate);

}  // namespace sinew
