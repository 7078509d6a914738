// Data that are checked before anything is fitted to them.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "datasets/check/finding.h"
#include "datasets/dataset.h"

namespace sinew {

/// What was found in a data set, and what it was looked for in.
struct CheckReport {
  std::vector<Finding> findings;  ///< those that spoil most first
  int trials = 0;
  int channels = 0;                   ///< over all trials
  std::map<std::string, int> cycles;  ///< of the trials that have any
};

/// Every detector on every channel of every trial, those of held-out trials too. O(N log N) in the samples.
/// Nothing is changed.
[[nodiscard]] CheckReport CheckData(const Dataset& dataset);

}  // namespace sinew
