// Names of the right and the left side of a body.
#pragma once

#include <string>
#include <vector>

namespace sinew {

/// What the same thing on the other side may be called: of "hip_r" "hip_l", of "R.Heel" "L.Heel", of "RHEE"
/// "LHEE", of "right_force_y" "left_force_y". Empty, if the name has no side; the caller looks which of them
/// exists.
[[nodiscard]] std::vector<std::string> OtherSides(const std::string& name);

}  // namespace sinew
