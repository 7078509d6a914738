// Where one burst of a muscle ends and the next begins.
#pragma once

#include <vector>

#include "base/linear_algebra.h"

namespace sinew {

/// Phases between the bursts of a muscle's mean EMG over a cycle, increasing [0..1): its lowest point, and
/// every valley that lies 3 % of its range below the bursts on both sides. For one recording: bursts shift
/// with speed, and a cut through a flank would give it the next burst's gain.
/// @param curve [N >= 1] at phases 0, 1 / N, ...
[[nodiscard]] std::vector<double> FindCuts(const Vector& curve);

/// Which burst a sample is of: as many numbers per cycle as there are cuts, increasing with time.
/// @param cuts increasing; none: cycles count, as with a cut at 0 @param phase [0..1)
[[nodiscard]] int BurstOf(const std::vector<double>& cuts, int cycle, double phase);

}  // namespace sinew
