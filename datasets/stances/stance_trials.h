// Trials of the stances of a recording.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "datasets/stances/stances.h"

namespace sinew {

struct StanceTrial {
  std::string name;  ///< TRIAL_PLATE_1, ... in the order of time
  Role role = Role::kTrain;
  Contact contact;
};

/// Names and roles of the contacts without fault: of every `validate_every` in the order of time the last one
/// is held out; of fewer the last one, if there are two. 0: none is.
[[nodiscard]] std::vector<StanceTrial> PlanStances(const std::string& trial, const TrialContacts& contacts,
                                                   int validate_every);

/// Cuts them out of their recording (CutTrial), each with the forces of its plate only. Errors: a trial of
/// that name is there already; the data set is then unchanged.
Status CutStances(Dataset& dataset, const std::string& trial, const std::vector<StanceTrial>& stances);

}  // namespace sinew
