#include "identify/diagnosis/select/rivals.h"

#include <algorithm>
#include <map>
#include <optional>

#include "identify/diagnosis/select/candidate_sets.h"
#include "identify/diagnosis/select/imitating_sets.h"

namespace sinew::diagnosis {
namespace {

// The refit of this set if it is one that the data do not distinguish from the model, else nullptr.
const Refit* AsGood(const LikelihoodComparison& compare, const std::vector<int>& released,
                    const Refit& model) {
  const Refit& refit = compare.at(released);
  return refit.usable() && compare.Penalised(refit, model) <= SetWidth(model) ? &refit : nullptr;
}

void AddRival(const LikelihoodComparison& compare, const std::vector<int>& chosen, int cause,
              const std::vector<int>& released, std::vector<Rival>& rivals) {
  const Refit& model = compare.at(chosen);
  const Refit* refit = AsGood(compare, released, model);
  if (refit == nullptr) return;
  for (const int c : released) {
    if (!Contains(chosen, c))
      rivals.push_back({c, cause, *refit, compare.Difference(*refit, model), compare.Correlation(c, cause)});
  }
}

void AddRivalPair(const LikelihoodComparison& compare, const std::vector<int>& chosen,
                  const std::vector<int>& released, std::vector<Rival>& rivals) {
  const Refit& model = compare.at(chosen);
  const Refit* refit = AsGood(compare, released, model);
  if (refit == nullptr) return;
  for (const int c : released) {
    const bool known =
        std::any_of(rivals.begin(), rivals.end(), [&](const Rival& rival) { return rival.candidate == c; });
    if (known) continue;
    const int like =
        compare.Correlation(c, chosen[0]) >= compare.Correlation(c, chosen[1]) ? chosen[0] : chosen[1];
    rivals.push_back({c, like, *refit, compare.Difference(*refit, model), compare.Correlation(c, like)});
  }
}

bool EndsAtABound(const LikelihoodComparison& compare, const Refit& refit, int c) {
  const auto& parameters = compare.candidate(c).parameters;
  return std::any_of(parameters.begin(), parameters.end(), [&](int index) {
    const Parameter& p = refit.setup->parameters[static_cast<std::size_t>(index)];
    const double value = refit.point[index];
    return value != p.null_value && (value <= p.lower || value >= p.upper);
  });
}

}  // namespace

Result<std::vector<std::vector<int>>> FitImitatingSets(LikelihoodComparison& compare,
                                                       const std::vector<int>& chosen) {
  std::vector<std::vector<int>> sets;
  if (compare.base().refit.noise.CountsPriors()) return sets;
  SINEW_ASSIGN(const auto wanted, FindImitatingSets(compare.problem(), compare.candidates(),
                                                    compare.at(chosen), compare.base().refit.point));
  compare.refits().Fit(wanted);
  for (const auto& [released, starts] : wanted) sets.push_back(released);
  return sets;
}

Result<std::vector<Rival>> FindRivals(LikelihoodComparison& compare, const std::vector<int>& chosen) {
  std::vector<Rival> rivals;
  for (const int c : chosen) {
    const std::vector<int> rest = Without(chosen, c);
    std::optional<ScoredModel> made;
    if (!rest.empty()) {
      if (compare.refits().FindUsable(rest) == nullptr) continue;
      SINEW_ASSIGN(made, compare.ScoresOf(rest));
    }
    const ScoredModel& scored = made ? *made : compare.base();
    std::map<std::vector<int>, std::vector<Vector>> wanted;
    for (const int other : compare.Singles(scored)) {
      if (!Contains(chosen, other))
        wanted[With(rest, other)] = RefitStarts(scored, compare.candidates(), other);
    }
    compare.refits().Fit(wanted);
    for (const auto& [released, starts] : wanted) AddRival(compare, chosen, c, released, rivals);
  }
  if (chosen.size() == 2) {
    for (const auto& [released, refit] : compare.refits().all()) {
      const bool disjoint =
          released.size() == 2 && !Contains(chosen, released[0]) && !Contains(chosen, released[1]);
      if (disjoint) AddRivalPair(compare, chosen, released, rivals);
    }
  }
  std::stable_sort(rivals.begin(), rivals.end(),
                   [](const Rival& a, const Rival& b) { return a.delta_lr < b.delta_lr; });
  return rivals;
}

std::vector<int> BetterSet(const LikelihoodComparison& compare, const std::vector<int>& chosen,
                           const std::vector<Rival>& rivals, const std::vector<std::vector<int>>& imitating) {
  const Refit* best = &compare.at(chosen);
  for (const Rival& rival : rivals) {
    if (compare.PenalisedByOccurrence(rival.refit, *best) < 0 &&
        !compare.IsSimplerDouble(chosen, rival.refit) && !EndsAtABound(compare, rival.refit, rival.candidate))
      best = &rival.refit;
  }
  for (const std::vector<int>& set : imitating) {
    const Refit* refit = compare.refits().FindUsable(set);
    if (refit == nullptr || compare.PenalisedByOccurrence(*refit, *best) >= 0) continue;
    const bool at_a_bound = std::any_of(set.begin(), set.end(), [&](int c) {
      return !Contains(chosen, c) && EndsAtABound(compare, *refit, c);
    });
    if (!at_a_bound) best = refit;
  }
  return best->released == chosen ? std::vector<int>() : best->released;
}

}  // namespace sinew::diagnosis
