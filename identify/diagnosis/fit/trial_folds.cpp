#include "identify/diagnosis/fit/trial_folds.h"

#include <algorithm>
#include <set>

namespace sinew::diagnosis {
namespace {

constexpr std::size_t kMaxFolds = 10;

}  // namespace

bool TrialFold::Has(const std::string& trial) const {
  return std::binary_search(trials.begin(), trials.end(), trial);
}

std::vector<std::string> TrainingTrials(const Problem& problem) {
  std::set<std::string> trials;
  for (const Block& block : problem.layout()) {
    if (block.role == BlockRole::kTrain) trials.insert(block.trial);
  }
  return {trials.begin(), trials.end()};
}

std::vector<TrialFold> FoldsOf(const Problem& problem) {
  const std::vector<std::string> trials = TrainingTrials(problem);
  std::vector<TrialFold> folds(std::min(trials.size(), kMaxFolds));
  for (std::size_t i = 0; i < trials.size(); ++i) folds[i % folds.size()].trials.push_back(trials[i]);
  return folds;
}

}  // namespace sinew::diagnosis
