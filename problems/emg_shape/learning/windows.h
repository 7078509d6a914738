// Bursts of one muscle in one recording, as a prediction uses them.
#pragma once

#include <limits>
#include <vector>

#include "problems/emg_shape/learning/bursts.h"

namespace sinew {

/// A burst, or all of a cycle that vary together. Places are phases of the muscle's shape, and count cycles
/// from the beginning of the recording's first.
struct EmgWindow {
  int first = 0;  ///< samples of the prediction in which it may be seen, from here
  int end = 0;    ///< to here, not included
  int cycle = 0;  ///< with whose bursts it varies together
  double begin = -std::numeric_limits<double>::infinity();  ///< place of `before`
  double finish = std::numeric_limits<double>::infinity();  ///< place of `after`
  BurstCut before;
  BurstCut after;
  bool fitted = false;  ///< compared samples are in it

  /// Of the EMG at a place that is this burst's.
  [[nodiscard]] BurstCut::Share ShareAt(double place) const;
};

/// In the order of time; each is seen as far as its neighbours reach, where its timing may take it.
/// @param apart each burst by itself, or all of a cycle together @param cycle [M] @param phase [M, 0..1)
/// @param compared indices into these, increasing
[[nodiscard]] std::vector<EmgWindow> FindEmgWindows(const BurstPattern& bursts, bool apart,
                                                    const std::vector<int>& cycle,
                                                    const std::vector<double>& phase,
                                                    const std::vector<int>& compared);

}  // namespace sinew
