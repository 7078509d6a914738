// One measured trial: the run that the integrator needs, and the motion that was measured.
#pragma once

#include <string>
#include <vector>

#include "datasets/dataset.h"
#include "models/drive/run.h"
#include "problems/drive/data/starts.h"
#include "problems/drive/effects.h"
#include "problems/drive/settings.h"

namespace sinew {

/// @param name of the trial. Errors: an input with a gap, fewer than 3 samples measured within it, no gains,
/// no supply voltage.
Result<DriveRun> ReadDriveRun(const Dataset& data, const DriveSettings& settings, const DriveTraits& traits,
                              const std::string& name, const Trial& trial);

/// Also sets the initial state of the run, which it points to.
/// Errors: fewer than 3 samples of position or speed.
Result<DriveMotion> MotionOf(const Trial& trial, DriveRun& run);

/// On the straight line between samples, constant beyond them; 0 if there are none.
double At(const std::vector<double>& time, const std::vector<double>& values, double t);

}  // namespace sinew
