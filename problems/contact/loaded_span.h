// From when to when a foot is on the floor.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "datasets/dataset.h"

namespace sinew {

/// The first and the last time [s] within from .. to at which the vertical force exceeds 2 % of its greatest
/// value; nothing if there are no two.
[[nodiscard]] std::optional<std::array<double, 2>> LoadedSpan(const std::vector<double>& time,
                                                              const std::vector<double>& force, double from,
                                                              double to);

/// The window that a trial was cut with (conditions window_start_s and window_end_s), if it was.
[[nodiscard]] std::optional<std::array<double, 2>> WindowOf(const Trial& trial);

}  // namespace sinew
