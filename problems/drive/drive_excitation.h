// Motions that a laboratory would ask of a joint to identify it.
#pragma once

#include "base/random.h"
#include "problems/drive/drive_laboratory.h"

namespace sinew {

/// Six sines between 0.1 and 3 Hz with drawn amplitudes, frequencies and phases, faded in and out within half
/// a second, as torque; scaled so that the joint of `nominal` swings to a drawn angle between 0.6 and 1.4 rad
/// (linear in between: the hanging joint stays clear of the upright). Released at a drawn angle of at most
/// 0.3 rad from rest.
Result<DriveTrial> DrawMultiSine(const DriveTruth& nominal, double duration, double rate, Random& random);

/// Moves between drawn angles within +-1.2 rad with trapezoidal speed and short rests, followed by a position
/// controller that is tuned for the joint of `nominal`.
DriveTrial DrawTrapezoid(const DriveTruth& nominal, double duration, double rate, Random& random);

/// Speed reference that runs the range of an ankle orthosis, -20 to +15 deg, back and forth, from 0 deg
/// upwards. @param first, second [rad/s] speeds before and after the middle of the trial.
DriveTrial BackAndForth(double first, double second, double duration, double rate);

}  // namespace sinew
