#include "identify/diagnosis/select/forward_step.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "identify/diagnosis/select/candidate_sets.h"

namespace sinew::diagnosis {
namespace {

using Set = std::vector<int>;
using Wanted = std::map<Set, std::vector<Vector>>;

// A refit that ends so many standard errors from the estimate of its score, or whose likelihood ratio differs
// from the score by kContradictingShare and by more than kSetWidth, contradicts the linear model.
constexpr double kContradictingErrors = 2.5;

// Whether the refit with one more candidate contradicts the linear model from which it was chosen.
bool ContradictsScore(const LikelihoodComparison& compare, const ScoredModel& scored, const Refit& refit,
                      int c) {
  const Score* score = scored.BestOf(c);
  if (!refit.usable() || score == nullptr) return false;
  const double gained = LikelihoodDifference(scored.refit, refit);
  const double difference = std::abs(gained - score->statistic);
  if (!refit.converged || difference > std::max(kSetWidth, kContradictingShare * score->statistic))
    return true;
  const Candidate& candidate = compare.candidate(c);
  const auto probe = static_cast<std::size_t>(score->probe);
  const auto covariance = compare.refitter().Covariance(refit);
  if (IsScoredBySecant(candidate, probe) || !covariance) return false;
  const LeastSquares fit(compare.problem(), *refit.setup);
  const Vector estimate = fit.Variables(RefitStarts(scored, compare.candidates(), c).front());
  for (const int index : ScoredParameters(candidate, probe)) {
    const auto& free = refit.setup->free;
    const auto v = std::find(free.begin(), free.end(), index) - free.begin();
    const double variance = (*covariance)(v, v);
    if (std::isfinite(variance) && variance > 0 &&
        std::abs(refit.x[v] - estimate[v]) > kContradictingErrors * std::sqrt(variance))
      return true;
  }
  return false;
}

void AddPairs(const LikelihoodComparison& compare, Wanted& wanted) {
  for (const auto& [a, b] : compare.shortlist().Pairs()) {
    Vector start = RefitStarts(compare.base(), compare.candidates(), a).front();
    const Vector second = RefitStarts(compare.base(), compare.candidates(), b).front();
    for (const int index : compare.candidate(b).parameters) start[index] = second[index];
    wanted[With({a}, b)].push_back(std::move(start));
  }
}

// Fits the sets with one more candidate, and pairs at the first cause; adds them to `wanted`.
const Refit* FitExtensions(LikelihoodComparison& compare, const Set& chosen, const ScoredModel& scored,
                           Wanted& wanted) {
  for (const int c : compare.Singles(scored)) {
    if (!Contains(chosen, c)) wanted[With(chosen, c)] = RefitStarts(scored, compare.candidates(), c);
  }
  if (chosen.size() == 1) AddPairs(compare, wanted);
  compare.refits().Fit(wanted);
  const Refit* best = nullptr;
  for (const auto& [released, starts] : wanted) {
    const Refit& refit = compare.at(released);
    if (refit.usable() && (best == nullptr || compare.Penalised(refit, *best) < 0)) best = &refit;
  }
  return best;
}

// True if the most significant score is that of a library effect, not of a discrepancy term.
bool BestIsKnown(const LikelihoodComparison& compare, const ScoredModel& scored) {
  double known = 1;
  for (std::size_t i = 0; i < scored.whitened.scores.size(); ++i) {
    if (compare.candidate(scored.whitened.scores[i].candidate).known)
      known = std::min(known, scored.family.score_p_value[i]);
  }
  return known <= scored.family.level;
}

}  // namespace

std::vector<int> ForwardStep(LikelihoodComparison& compare, const std::vector<int>& chosen,
                             const ScoredModel& scored) {
  Wanted wanted;
  const Refit* best = FitExtensions(compare, chosen, scored, wanted);
  if (best == nullptr) return {};
  if (!compare.scores_contradicted() && best->released.size() == chosen.size() + 1) {
    Set added;
    std::set_difference(best->released.begin(), best->released.end(), chosen.begin(), chosen.end(),
                        std::back_inserter(added));
    // Beside hundreds of values that follow the data refits end at neighbouring minima: those of all
    // candidates would say no more than their scores, and take hours.
    const bool many_minima = compare.base().refit.noise.CountsPriors();
    if (!many_minima && ContradictsScore(compare, scored, *best, added.front())) {
      compare.DistrustScores();
      best = FitExtensions(compare, chosen, scored, wanted);
    }
  }
  for (const auto& [released, starts] : wanted) {
    if (compare.IsSimplerDouble(released, *best)) best = &compare.at(released);
  }
  const Refit& before = compare.at(chosen);
  if (compare.GainsTooLittle(*best, before)) return {};
  Set more;
  const std::size_t extra = best->released.size() - chosen.size();
  for (const int c : best->released) {
    if (!Contains(chosen, c)) more.push_back(c);
  }
  if (more.size() > extra) more.resize(std::max<std::size_t>(extra, 1));
  const double level = chosen.empty() ? compare.options().alarm_level : kFurtherLevel;
  const bool by_score = scored.family.p_value <= level && BestIsKnown(compare, scored);
  if (!by_score && compare.PValue(LikelihoodDifference(before, *best), more) > level) return {};
  if (compare.Penalised(*best, before) >= 0) return {};
  return best->released;
}

}  // namespace sinew::diagnosis
