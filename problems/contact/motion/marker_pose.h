// The pose of a foot by its own markers. Inverse kinematics of a whole body puts up with errors of a foot for
// the sake of the rest: a standing foot slides by centimetres. The markers on the foot itself do not.
#pragma once

#include <array>

#include "problems/contact/motion/foot_markers.h"
#include "problems/contact/motion/foot_motion.h"

namespace sinew {

/// What the markers' noise from frame to frame leaves in a pose that follows them smoothly.
struct PoseNoise {
  double marker = 0;                                ///< standard deviation of a marker along an axis [m]
  std::array<double, kPoseComponents> deviation{};  ///< of each PoseComponent [m, rad]
  double time = 0.05;                               ///< a deviation over that of its rate [s]
};

struct MarkerPose {
  double residual_recorded = 0;  ///< root mean square distance of markers and model as recorded [m]
  double residual = 0;           ///< the same with the new pose, and markers where they are placed [m]
  double shift = 0;              ///< root mean square of the foot's shift along an axis [m]
  double turn = 0;               ///< of its rotation about an axis [rad]
  PoseNoise noise;               ///< of the new pose
};

/// Moves the foot to where its own markers say: smooth curves of the pose (PoseComponent) and a constant
/// place of every marker on the foot, the most probable ones with priors about the recorded motion and the
/// model's places, which decide what few markers leave open. Sets Marker::location to the places found.
/// @param times [T, s] of the foot's motion. Does nothing without markers.
MarkerPose MoveToMarkers(const std::vector<double>& times, FootMotion& foot, FootMarkers& markers);

}  // namespace sinew
