// Starts for the base parameters by linear regression, from any data.
#pragma once

#include <optional>
#include <vector>

#include "models/drive/dynamics.h"
#include "problems/drive/data/motion.h"
#include "problems/drive/effects.h"

namespace sinew {

/// Least squares in the weak form (weak_form.h). The inertia is that beside dry friction and an offset; for
/// the others both are ignored, because the base model has neither. These are starts.
/// @return all base parameters; where the data do not determine them, an order of magnitude.
[[nodiscard]] DriveStarts EstimateDriveStarts(const DriveJoint& joint, const DriveCommand& command,
                                              const std::vector<DriveMotion>& motions,
                                              const std::array<std::optional<double>, kDriveSlots>& fixed);

}  // namespace sinew
