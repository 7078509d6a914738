#include "datasets/check/two_feet.h"

#include <algorithm>
#include <map>

#include "datasets/robust.h"
#include "datasets/stances/stances.h"

namespace sinew {
namespace {

constexpr std::size_t kManyContacts = 8;

}  // namespace

std::vector<Finding> FindTwoFeet(const Dataset& dataset) {
  std::vector<Finding> found;
  for (const auto& [trial_name, trial] : dataset.trials) {
    std::map<std::string, std::vector<Contact>> of_plate;
    for (const Contact& contact : FindContacts(trial).contacts) of_plate[contact.plate].push_back(contact);
    for (const auto& [plate, contacts] : of_plate) {
      Finding finding;
      finding.kind = FindingKind::kTwoFeet;
      finding.trial = trial_name;
      finding.channel = plate + "_force_y";
      finding.unit = "N";
      finding.other = plate;
      finding.among = static_cast<int>(contacts.size());
      std::vector<double> durations;
      for (const Contact& contact : contacts) {
        durations.push_back(contact.to - contact.from);
        // Among many steps one that lasts much longer is no step.
        const bool is_long = contact.fault == ContactFault::kLong && contacts.size() >= kManyContacts &&
                             contact.to < contacts.back().from;
        if (contact.fault != ContactFault::kTwoFeet && !is_long) continue;
        finding.spans.push_back({contact.from, contact.to});
        finding.size = std::max(finding.size, contact.to - contact.from);
      }
      if (finding.spans.empty()) continue;
      finding.usual = Median(durations);
      for (const auto& [grid_name, grid] : trial.grids) {
        if (grid.channels.count(finding.channel) != 0) finding.grid = grid_name;
      }
      found.push_back(std::move(finding));
    }
  }
  return found;
}

}  // namespace sinew
