// Further trials in addition to a case's ordinary ones.
#pragma once

#include <string>
#include <vector>

#include "problems/drive/laboratory/synthesis.h"

namespace sinew {

/// Their kinds: `same` (one more of the plan's own), rest, creep, hold, fast, sharp (ten times the plan's
/// rate).
const std::vector<std::string>& FurtherKinds();

/// The experiment of `plan` with other trials: one training trial of each kind, as long as those of the plan,
/// with their own motion and noise, the same truth and the same scale of its commands.
/// @param plan an ordinary one without effects: the motions are designed for its joint. Errors: those of
/// SimulateDrive.
Result<DrivePlan> PlanFurther(const DrivePlan& plan, const std::vector<std::string>& kinds,
                              std::uint64_t seed);

}  // namespace sinew
