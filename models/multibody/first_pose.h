// The pose with which inverse kinematics begins: the lowest of the minima that several starts lead to.
// Internal to models/.
#pragma once

#include "base/random.h"
#include "models/multibody/inverse_kinematics.h"
#include "models/multibody/marker_fit.h"

namespace sinew {

struct FirstPose {
  MarkerFit::Solution solution;
  int starts = 0;
  int agreeing = 0;  ///< starts that end at the lowest cost
};

/// Of the frame that `fit` is set to. Starts: the default pose; the same turned by quarter turns about each
/// angle between ground and the first bodies, so that a person may face any way; then poses whose angles are
/// random within their ranges, at least 8, until three end at the lowest cost or 40 are done; at last the
/// escapes of FindLowerPose. Of equal minima (angles that describe one pose in two ways) the one nearest to
/// the default pose.
FirstPose FindFirstPose(MarkerFit& fit, const MultibodyModel& model, const IkOptions& options,
                        Random& random);

/// Draws the angles of a pose anew within their ranges, one by one and with the two that follow (the limbs'
/// wrong minima do not depend on each other, so that this finds what random whole poses of many coordinates
/// hardly meet), and starts from there; a lower minimum is tried in the same way, until none is found.
/// @param others  poses of other frames, whose angles within the body are tried first
/// @return the pose itself if there is none
MarkerFit::Solution FindLowerPose(MarkerFit& fit, const MultibodyModel& model, const IkOptions& options,
                                  const MarkerFit::Solution& pose, const std::vector<Vector>& others,
                                  Random& random);

}  // namespace sinew
