#include "identify/diagnosis/select/cross_validated_selection.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace sinew::diagnosis {

void TakeOver(const CrossValidatedSearch& search, CrossValidatedSearch::Outcome found,
              const std::vector<Candidate>& candidates, const ScoredModel& base, Selection& selection) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  selection.left_out = search.fitter().folds();
  selection.searched = TrainingTrials(search.fitter().searched()).size();
  selection.ladder.clear();
  for (const CrossValidatedSearch::Step& step : found.ladder) {
    LadderStep told{{}, step.error / found.base_error};
    for (const int c : step.released) told.effects.push_back(candidates[static_cast<std::size_t>(c)].effect);
    selection.ladder.push_back(std::move(told));
  }
  selection.judged.clear();
  for (CrossValidatedSearch::Step& set : found.judged)
    selection.judged.push_back({std::move(set.released), set.error / found.base_error});
  selection.resampled.clear();
  for (CrossValidatedSearch::Resampled& set : found.resampled)
    selection.resampled.push_back({std::move(set.released), std::move(set.point), set.share});
  selection.chosen_shares = std::move(found.chosen_shares);
  selection.causes.clear();
  for (const auto& [c, share] : found.left_out_shares) selection.causes.push_back({c, kNaN, kNaN, share});
  std::stable_sort(selection.causes.begin(), selection.causes.end(),
                   [](const ChosenCause& a, const ChosenCause& b) { return a.left_out < b.left_out; });
  selection.rivals.clear();
  for (Substitute& other : found.substitutes) {
    const Score* first = base.BestOf(other.candidate);
    const Score* second = base.BestOf(other.cause);
    const double correlation =
        first != nullptr && second != nullptr ? base.whitened.Correlation(*first, *second) : 0;
    selection.rivals.push_back(
        {other.candidate, other.cause, std::move(other.refit), kNaN, correlation, other.error});
  }
  selection.model = std::move(found.model);
  if (!found.beside) return;
  selection.terms = found.beside->terms;
  selection.imitations = found.beside->imitations;
  Selection plain = selection;
  plain.terms.clear();
  plain.imitations.clear();
  TakeOver(search, *found.plain, candidates, base, plain);
  selection.refitter = found.refitter;
  selection.without_terms = std::make_shared<Selection>(std::move(plain));
}

}  // namespace sinew::diagnosis
