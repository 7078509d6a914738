// The folds of cross-validation: training trials in groups that are left out of a fit in turn.
#pragma once

#include <string>
#include <vector>

#include "identify/problem.h"

namespace sinew::diagnosis {

struct TrialFold {
  std::vector<std::string> trials;  ///< increasing

  [[nodiscard]] bool Has(const std::string& trial) const;
};

/// Every trial on its own, or ten groups if there are more than ten trials. Trials are assigned to the groups
/// in turn, so that each group contains all parts of a session.
[[nodiscard]] std::vector<TrialFold> FoldsOf(const Problem& problem);

/// Training trials, each once, by name.
[[nodiscard]] std::vector<std::string> TrainingTrials(const Problem& problem);

}  // namespace sinew::diagnosis
