// The poses of all frames of a recording: forward and backward from the first one found, until no frame's
// cost falls when it is started from a neighbour. Internal to models/.
#pragma once

#include <optional>
#include <vector>

#include "models/multibody/inverse_kinematics.h"
#include "models/multibody/marker_fit.h"

namespace sinew {

struct FramePoses {
  std::vector<std::optional<MarkerFit::Solution>> of_frame;  ///< empty in frames without any marker
  int starts = 0;                                            ///< of the frame with which the search begins
  int agreeing_starts = 0;                                   ///< those that end at its lowest cost
  std::vector<int> redone;  ///< frames that got a lower minimum than their first one
};

/// Begins at the first frame in which the markers present weigh most (with all markers present: the first).
/// After the passes the last frame (where a wrong minimum that was entered on the way may still hold), of
/// every 40 frames the one of the largest cost, and the frames on both sides of a jump of the pose are
/// searched by FindLowerPose; a lower pose goes on to the neighbours. At last the angles are made continuous
/// where one placement has several sets of them.
FramePoses SolveFrames(MarkerFit& fit, const MultibodyModel& model, const MarkerTrajectories& markers,
                       const IkOptions& options);

}  // namespace sinew
