// The period of a movement, from the whole recording at once.
#pragma once

#include <vector>

namespace sinew {

struct MovementPeriod {
  double period_s = 0;     ///< [s]; 0: nothing repeats
  double correlation = 0;  ///< of the movement with itself one period later [-1..1]
};

/// The first lag at which the autocorrelation peaks within a tenth of its highest peak; each lag's value is
/// divided by the energies of the two stretches that it compares. A movement that repeats less than twice, or
/// whose correlation stays below 0.3, has no period. It does not use turning points, and serves to check
/// them.
///
/// Works on means over at most 2048 equal stretches of time: O(N) and a constant. Periods of fewer than 6 of
/// them (a third of a second in two minutes) are not found.
/// @param time [N, s, strictly increasing] @param angle [N, any unit; NaN where there is a gap]
[[nodiscard]] MovementPeriod FindMovementPeriod(const std::vector<double>& time,
                                                const std::vector<double>& angle);

}  // namespace sinew
