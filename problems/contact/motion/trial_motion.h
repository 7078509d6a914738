// The coordinates of a trial as smooth functions of time.
#pragma once

#include <vector>

#include "datasets/dataset.h"
#include "models/multibody/coordinate_trajectory.h"
#include "models/multibody/multibody_model.h"

namespace sinew {

struct TrialMotion {
  CoordinateTrajectory trajectory;
  std::vector<double> time;  ///< [N, s] of its samples
};

/// Of the grid that holds most coordinates of the model. Samples at the ends where a coordinate is missing
/// are left out; a gap inside is an error, because a spline across it would be an invention. Errors: that,
/// and a trial without coordinates; the sentence goes on after the trial's name.
Result<TrialMotion> FitTrialMotion(const Trial& trial, const MultibodyModel& model);

/// Frames per second [Hz]. Errors: fewer than ten frames, or frames that are not equally spaced, which no
/// filter takes; the sentence goes on after the trial's name.
[[nodiscard]] Result<double> FrameRate(const TrialMotion& motion);

}  // namespace sinew
