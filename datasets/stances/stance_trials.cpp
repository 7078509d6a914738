#include "datasets/stances/stance_trials.h"

#include <map>

#include "datasets/cut.h"

namespace sinew {

std::vector<StanceTrial> PlanStances(const std::string& trial, const TrialContacts& contacts,
                                     int validate_every) {
  std::vector<StanceTrial> stances;
  std::map<std::string, int> count;
  for (const Contact& contact : contacts.contacts) {
    if (contact.fault != ContactFault::kNone) continue;
    const int number = ++count[contact.plate];
    stances.push_back({fmt::format("{}_{}_{}", trial, contact.plate, number), Role::kTrain, contact});
  }
  if (validate_every <= 0) return stances;
  const auto step = static_cast<std::size_t>(validate_every);
  for (std::size_t i = step; i <= stances.size(); i += step) stances[i - 1].role = Role::kValidate;
  if (stances.size() >= 2 && stances.size() < step) stances.back().role = Role::kValidate;
  return stances;
}

Status CutStances(Dataset& dataset, const std::string& trial, const std::vector<StanceTrial>& stances) {
  const auto cut = [&](const StanceTrial& stance) -> Status {
    TrialWindow window;
    window.trial = trial;
    window.start_s = stance.contact.from;
    window.end_s = stance.contact.to;
    window.name = stance.name;
    window.role = stance.role;
    SINEW_TRY(CutTrial(dataset, window));
    const Status kept = KeepPlates(dataset.trials.at(stance.name), {stance.contact.plate});
    if (!kept) dataset.trials.erase(stance.name);
    return kept;
  };
  for (std::size_t i = 0; i < stances.size(); ++i) {
    const Status done = cut(stances[i]);
    if (done) continue;
    for (std::size_t k = 0; k < i; ++k) dataset.trials.erase(stances[k].name);
    return done;
  }
  return {};
}

}  // namespace sinew
