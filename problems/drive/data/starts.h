// Starts for the base parameters by linear regression, from any data.
#pragma once

#include <optional>
#include <vector>

#include "models/drive/dynamics.h"
#include "models/drive/run.h"
#include "problems/drive/effects.h"

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

/// What reached the motor [N*m or V] at the motion's times, from the recorded input and, in closed loop, from
/// what the controller would have made of the measured motion.
[[nodiscard]] std::vector<double> ReplayCommand(const DriveCommand& command, const DriveMotion& motion);

/// Weak form: the equation of motion times smooth windows, integrated by parts until nothing measured is
/// differentiated, is linear in the parameters. The inertia is that beside dry friction and an offset; for
/// the others both are ignored, because the base model has neither. These are starts. Source: Preisig &
/// Rippin, Theory and application of the modulating function method, Comput. Chem. Eng. 17 (1993).
/// @return all base parameters; where the data do not determine them, an order of magnitude.
[[nodiscard]] DriveStarts EstimateDriveStarts(const DriveJoint& joint, const DriveCommand& command,
                                              const std::vector<DriveMotion>& motions,
                                              const std::array<std::optional<double>, kDriveSlots>& fixed);

}  // namespace sinew
