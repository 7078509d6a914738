// How a muscle's moment arm changes with the angle of its joint, from what was recorded of both.
#pragma once

#include <vector>

#include "base/linear_algebra.h"

namespace sinew {

/// Slope of a moment arm over the angle of its own joint. The arm of all trials together is described by a
/// polynomial in that angle, of the fourth degree at most and no higher than needed, with terms in the angles
/// of other joints (linear, and times the own angle), by least squares; the slope is the polynomial's.
/// @param arm [trials] [N, m]
/// @param angles [trials] [joints >= 1] [N, rad] that joint first, then others that the muscle crosses
/// @return [trials] [N, m/rad]; empty if the angle hardly changes or the polynomial leaves more than a
/// twentieth of the arm's variance
[[nodiscard]] std::vector<Vector> ArmSlopes(const std::vector<Vector>& arm,
                                            const std::vector<std::vector<Vector>>& angles);

}  // namespace sinew
