// Data that the fitted model makes itself, for tests: an inverse crime on purpose.
#pragma once

#include <map>
#include <string>

#include "base/error.h"
#include "datasets/dataset.h"
#include "problems/drive/laboratory/truth.h"

namespace sinew {

/// Replaces position and speed of every trial by what DriveProblem predicts for this truth.
/// @param starts initial_position@TRIAL and initial_speed@TRIAL; 0 where missing. Errors: those of
/// DriveProblem; a parameter of the truth that is not at its null and that the model does not have.
Status MakeExact(const DriveTruth& truth, const std::map<std::string, double>& starts, Dataset& data);

}  // namespace sinew
