// Positions that drift because nothing feeds them back to a measured force or torque.
#pragma once

#include <optional>
#include <vector>

#include "identify/warning.h"
#include "problems/drive/data/data.h"

namespace sinew {

/// A warning with the trials whose error is a drift, if the joint is driven by a recorded force or torque: at
/// least half of the squared error is a polynomial of third order in time (all drifting trials together), or
/// it grows from each quarter to the next and is ten times as large in the last one as in the first. Errors
/// below five times the noise, or below 0.1 % of the position's spread, do not count.
/// @param predicted [layout size][predictions]
[[nodiscard]] std::optional<Warning> OpenLoopDrift(const DriveData& data,
                                                   const std::vector<Vector>& predicted);

}  // namespace sinew
