// What was measured of the motion of a joint, and what drove it then.
#pragma once

#include <cstddef>
#include <vector>

#include "models/drive/dynamics.h"
#include "models/drive/run.h"

namespace sinew {

/// What was measured of one trial, at times from its begin; gaps left out.
struct DriveMotion {
  const DriveRun* run = nullptr;
  std::vector<double> time;
  std::vector<double> position;
  std::vector<double> speed;  ///< measured, or a smoothed difference
  bool speed_measured = false;
};

/// Slope of a straight line through the samples within `reach` of sample i (at least two on each side, as far
/// as there are).
[[nodiscard]] double LocalSlope(const std::vector<double>& time, const std::vector<double>& values,
                                std::size_t i, double reach);

/// Median time between samples of all trials [s]; 0 without any.
[[nodiscard]] double UsualInterval(const std::vector<DriveMotion>& motions);

/// The recorded input at a time of the trial: between its samples straight, or held.
[[nodiscard]] double RecordedInput(const DriveRun& run, double t);

/// What reached the motor [N*m or V] at the motion's times, from the recorded input and, in closed loop, from
/// what the controller would have made of the measured motion.
[[nodiscard]] std::vector<double> ReplayCommand(const DriveCommand& command, const DriveMotion& motion);

}  // namespace sinew
