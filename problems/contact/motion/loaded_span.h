// From when to when a foot is on the floor.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "datasets/dataset.h"

namespace sinew {

/// The first and the last time [s] within from .. to at which the vertical force exceeds 5 % of its greatest
/// value and four times its noise, and from there outwards as long as it exceeds 2 %: noise beside the stance
/// is no load. Nothing if there are no two.
/// @param noise standard deviation of the force [N]; 0: not known
[[nodiscard]] std::optional<std::array<double, 2>> LoadedSpan(const std::vector<double>& time,
                                                              const std::vector<double>& force, double from,
                                                              double to, double noise);

/// The window that a trial was cut with (conditions window_start_s and window_end_s), if it was.
[[nodiscard]] std::optional<std::array<double, 2>> WindowOf(const Trial& trial);

}  // namespace sinew
