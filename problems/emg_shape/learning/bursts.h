// How the bursts of one muscle follow each other in a cycle.
#pragma once

#include <vector>

#include "base/linear_algebra.h"

namespace sinew {

/// Between two bursts. They overlap: the share of the later one rises as a logistic function of the phase, as
/// it does for two bell curves.
struct BurstCut {
  double phase = 0;      ///< [0..1)
  double steepness = 0;  ///< of the logistic function [1 / cycle]
  double reach = 0;      ///< before and after it both bursts count [cycle]

  struct Share {
    double value = 0;
    double slope = 0;  ///< per cycle
  };
  /// Of the later burst. @param since the cut [cycle]
  [[nodiscard]] Share Later(double since) const;
};

/// Bursts of one muscle in one recording. Cuts lie where the muscle is least active, not where the movement
/// turns: a burst over the turn is one.
struct BurstPattern {
  std::vector<BurstCut> cuts;  ///< increasing; none: as with one at 0
  int main = 0;                ///< which of a cycle's bursts is the largest [0..count)
  int after = 0;  ///< how many of those that follow it vary together with it; the others do so with
                  ///< the next main one [0..count)

  [[nodiscard]] int count() const { return cuts.empty() ? 1 : static_cast<int>(cuts.size()); }
  /// Which burst a sample is of: `count` numbers per cycle, increasing with time. @param phase [0..1)
  [[nodiscard]] int BurstAt(int cycle, double phase) const;
  /// Which of a cycle's bursts that is [0..count).
  [[nodiscard]] int IndexOf(int burst) const;
  /// The cycle with whose main burst a burst varies together.
  [[nodiscard]] int CycleOf(int burst) const;
};

/// Cuts at the lowest point of a muscle's mean EMG over a cycle, and in every valley that lies 3 % of its
/// range below the bursts on both sides. For one recording: bursts shift with speed, and a cut through a
/// flank would give it the next burst's gain. How steep they are follows from the bursts' distance and their
/// widths at half of their height.
/// @param curve [N >= 1] at phases 0, 1 / N, ...
[[nodiscard]] BurstPattern FindBursts(const Vector& curve);

}  // namespace sinew
