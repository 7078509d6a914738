// Cycles with several high points, as a knee's or an ankle's in walking: which of them is the beginning.
#pragma once

#include <cstddef>
#include <vector>

#include "models/emg/turning_points.h"

namespace sinew {

struct AlignedPoints {
  std::vector<TurningPoint> points;  ///< in the order of time
  std::size_t moved = 0;             ///< beginnings that are not the most extreme point of their cycle
  double phase =
      0;  ///< where beginnings lie on the way from one reversal to the next [0..1]; set if moved > 0
  /// Intervals between beginnings, and between reversals, that differ from their median by over 10 %.
  std::size_t irregular_beginnings = 0;
  std::size_t irregular_reversals = 0;
};

/// Where two high points are almost equal, now the one and now the other is the highest. If the beginnings
/// come less regularly than the reversals (more intervals that differ from their median by over 10 %), all
/// are taken at the phase, from one reversal to the next, where most of them lie: of the turning points
/// within 10 % of the cycle around it the most extreme one. Where there is none the beginning stays, and so
/// it does where it would move by more than 40 % of the range of angles.
///
/// @param points large ones, highest and lowest in turn @param small all turning points, also the small ones
/// @param from_highest beginnings are the highest points @param range of the angle [unit of the angle]
[[nodiscard]] AlignedPoints AlignBeginnings(const std::vector<TurningPoint>& points,
                                            const std::vector<TurningPoint>& small, bool from_highest,
                                            double range);

}  // namespace sinew
