#include "identify/diagnosis/select/selection.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "identify/diagnosis/select/cross_validated_selection.h"
#include "identify/diagnosis/select/forward_step.h"
#include "identify/diagnosis/select/likelihood_comparison.h"

namespace sinew::diagnosis {
namespace {

constexpr int kMaxCauses = 5;
constexpr int kMaxSteps = 10;     // mostly as many as there are causes; each lowers the deviance
constexpr int kMaxExchanges = 8;  // each lowers the deviance, so that the loop would end without this limit
constexpr double kNearUnitRoot = 0.97;  // root of the noise model above which it may describe an effect
// Relative error of a score by its linearity, per square root of the score: 1 % at size 3, 4 % at size 12.
constexpr double kCurvature = 1e-3;

class Selector {
 public:
  Selector(const Problem& problem, Refitter& refitter, const std::vector<Candidate>& candidates,
           const ScoredModel& base, const DiagnosisOptions& options)
      : refitter_(refitter), scale_(problem), compare_(problem, refitter, candidates, base, options) {}

  Result<Selection> Run() {
    Selection selection;
    selection.family_p_value = compare_.base().AlarmPValue();
    selection.alarm = selection.family_p_value <= compare_.options().alarm_level;
    selection.model = compare_.base().refit;
    if (!selection.alarm && !NoiseMayAbsorbEffect()) return selection;

    std::vector<int> chosen;
    ScoredModel scored = compare_.base();
    if (compare_.base().refit.noise_absorbs_misfit ||
        scale_.At(compare_.base().refit).Dominates(compare_.base().refit.noise)) {
      SINEW_TRY(SearchByCrossValidation(selection, chosen));
      if (selection.cross_validated) return selection;
      selection.found_by_search = !chosen.empty();
      if (selection.found_by_search) {
        compare_.CompareAsAfterSearch();
        selection.alarm = true;
        selection.family_p_value = std::min(selection.family_p_value, compare_.options().alarm_level);
        SINEW_ASSIGN(scored, compare_.ScoresOf(chosen));
      }
    }
    SINEW_TRY(Extend(selection, chosen, scored));
    for (const auto& [released, refit] : compare_.refits().all()) {
      if (released.size() == 1 && refit.usable()) selection.tried.push_back(refit);
    }
    if (!selection.alarm) return selection;
    Eliminate(chosen);
    SINEW_ASSIGN(const bool unknown_is_better, UnknownTermFitsBetter(chosen));
    if (unknown_is_better) chosen.clear();
    for (int exchanges = 0;; ++exchanges) {
      selection.causes.clear();
      Judge(chosen, selection);
      if (const ChosenCause* worse = LowersTheLikelihood(selection)) {
        chosen = Without(chosen, worse->candidate);
        continue;
      }
      SINEW_ASSIGN(const std::vector<Set> imitating, FitImitatingSets(compare_, chosen));
      SINEW_ASSIGN(selection.rivals, FindRivals(compare_, chosen));
      const Set better = BetterSet(compare_, chosen, selection.rivals, imitating);
      if (better.empty() || exchanges >= kMaxExchanges) break;
      chosen = better;
      Eliminate(chosen);
    }
    SINEW_ASSIGN(scored, compare_.ScoresOf(chosen));
    selection.model = compare_.at(chosen);
    // Significant it may still be: an input that was recorded in a loop holds the noise of what was fed back.
    if (compare_.found_by_search() && !chosen.empty() &&
        scale_.At(selection.model).IsNoise(selection.model.noise))
      return selection;
    SINEW_TRY(CompareWithFree(chosen, scored, selection));
    FindRemainingStructure(scored, chosen.empty(), selection);
    return selection;
  }

 private:
  using Set = std::vector<int>;

  // If what one known cause leaves may be noise, the steps by likelihood are more powerful. If it takes
  // several, these steps continue from them; if a misfit is left, cross-validation decides.
  Status SearchByCrossValidation(Selection& selection, Set& chosen) {
    CrossValidatedSearch search(compare_.problem(), compare_.refitter(), compare_.candidates(), scale_,
                                compare_.options());
    if (!search.possible()) return {};
    SINEW_ASSIGN(auto outcome, search.Run(compare_.base()));
    if (!outcome) return {};
    CrossValidatedSearch::Outcome& found = *outcome;
    if (!found.misfit_left) refitter_.ExpectInputNoise(found.released, found.model.point);
    if (!found.misfit_left && found.released.size() > 1) {
      chosen = found.released;
      std::sort(chosen.begin(), chosen.end());
      compare_.refits().Fit({{chosen, {found.model.point}}});
      if (!compare_.at(chosen).usable()) chosen.clear();
    }
    if (!found.misfit_left || (found.released.empty() && !found.beside)) return {};
    selection.alarm = true;
    selection.cross_validated = true;
    selection.family_p_value = std::min(selection.family_p_value, compare_.options().alarm_level);
    selection.structure_left = true;
    TakeOver(search, std::move(found), compare_.candidates(), compare_.base(), selection);
    return {};
  }

  // Forward steps, as long as what is left is significant. @param scored of the chosen set
  Status Extend(Selection& selection, Set& chosen, ScoredModel& scored) {
    for (int steps = 0; steps < kMaxSteps && static_cast<int>(chosen.size()) < kMaxCauses; ++steps) {
      if (!chosen.empty() && scored.family.p_value > kFurtherLevel) break;
      const Set next = ForwardStep(compare_, chosen, scored);
      if (next.empty()) break;
      if (!selection.alarm) {
        selection.alarm = true;
        selection.family_p_value = compare_.options().alarm_level;
      }
      chosen = next;
      // Before further causes mend what a wrong set leaves.
      SINEW_ASSIGN(const std::vector<Set> imitating, FitImitatingSets(compare_, chosen));
      const Set better = BetterSet(compare_, chosen, {}, imitating);
      if (!better.empty()) chosen = better;
      SINEW_ASSIGN(scored, compare_.ScoresOf(chosen));
    }
    return {};
  }

  // Coloured noise with a root near one, or a process deviation far above that of its innovations, may be an
  // effect that the noise model has absorbed.
  [[nodiscard]] bool NoiseMayAbsorbEffect() const {
    const auto& channels = compare_.base().refit.noise.channels;
    return std::any_of(channels.begin(), channels.end(), [](const noise::ChannelNoiseModel& channel) {
      return channel.LargestRoot() > kNearUnitRoot;
    });
  }

  // True if one curve of one signal fits better than all effects of the library: then the cause is not in it.
  // The scores at the base model are compared before any refit, and the result counts only if the refit
  // confirms that the known causes explain little more. Scores are linear, and their error grows with the
  // size of the effect. Where no noise model is valid, the comparison is not made.
  // Where the refit contradicts the scores of the named effects (a base fit far from the truth), those of the
  // terms are no better: then a term can only be better if the named effects leave something significant.
  // Causes that a search by cross-validation found take a misfit that dominates the noise down to the noise,
  // of which no term leaves less; the noise of the base model, whose likelihood the scores are, has absorbed
  // that misfit.
  [[nodiscard]] Result<bool> UnknownTermFitsBetter(const Set& chosen) const {
    if (chosen.empty() || compare_.base().refit.noise_absorbs_misfit || compare_.found_by_search())
      return false;
    std::vector<const Score*> known;
    for (const int c : chosen) {
      const Score* score = compare_.base().BestOf(c);
      if (score != nullptr) known.push_back(score);
    }
    const double linear = JointStatistic(compare_.base().whitened, known);
    const double refitted = -compare_.Difference(compare_.at(chosen), compare_.at({}));
    const double explained = std::max(linear, refitted) - compare_.Price(chosen);
    const double neglected = kCurvature * std::pow(std::max(linear, 0.0), 1.5);
    for (const Score& score : compare_.base().whitened.scores) {
      if (compare_.candidate(score.candidate).known) continue;
      const double price = kPerParameter * (static_cast<double>(score.directions.size()) + score.searched);
      if (score.statistic - price <= explained + neglected + SetWidth(compare_.base().refit)) continue;
      if (std::abs(linear - refitted) <= kContradictingShare * std::max(linear, refitted)) return true;
      SINEW_ASSIGN(const ScoredModel left, compare_.ScoresOf(chosen));
      return left.AlarmPValue() <= kFurtherLevel;
    }
    return false;
  }

  // Backward elimination of causes whose likelihood ratio is below their penalty.
  void Eliminate(Set& chosen) {
    bool again = chosen.size() > 1;
    while (again) {
      again = false;
      const std::vector<Set> smaller_sets = compare_.refits().FitWithoutEach(chosen);
      const Set* best = nullptr;
      for (const Set& released : smaller_sets) {
        if (compare_.at(released).usable() &&
            (best == nullptr || compare_.Penalised(compare_.at(released), compare_.at(*best)) < 0))
          best = &released;
      }
      if (best == nullptr) return;
      Set gone;
      std::copy_if(chosen.begin(), chosen.end(), std::back_inserter(gone),
                   [&](int c) { return !Contains(*best, c); });
      const Refit& smaller = compare_.at(*best);
      const Refit& model = compare_.at(chosen);
      const bool by_likelihood =
          !compare_.found_by_search() || (model.holds_input_noise && smaller.holds_input_noise);
      if (!by_likelihood && !compare_.GainsTooLittle(model, smaller)) return;
      if (compare_.PValue(LikelihoodDifference(smaller, model), gone) <= compare_.options().alarm_level)
        return;
      chosen = *best;
      again = chosen.size() > 1;
    }
  }

  void Judge(const Set& chosen, Selection& selection) {
    const Refit& model = compare_.at(chosen);
    for (const int c : chosen) {
      const Refit* without = compare_.refits().FindUsable(Without(chosen, c));
      ChosenCause cause;
      cause.candidate = c;
      if (without != nullptr) cause.delta_lr = compare_.Difference(*without, model);
      cause.p_value = compare_.PValue(cause.delta_lr, {c});
      if (chosen.size() == 1) {
        for (std::size_t i = 0; i < compare_.base().whitened.scores.size(); ++i) {
          if (compare_.base().whitened.scores[i].candidate == c)
            cause.p_value = std::min(cause.p_value, compare_.base().family.score_p_value[i]);
        }
      }
      selection.causes.push_back(cause);
    }
    std::stable_sort(selection.causes.begin(), selection.causes.end(),
                     [](const ChosenCause& a, const ChosenCause& b) { return a.delta_lr > b.delta_lr; });
  }

  // A cause without which the model fits better: its refit, or the search over sets, ended at a minimum that
  // the smaller model leaves. nullptr: there is none.
  static const ChosenCause* LowersTheLikelihood(const Selection& selection) {
    for (const ChosenCause& cause : selection.causes) {
      if (cause.delta_lr < 0) return &cause;
    }
    return nullptr;
  }

  Status CompareWithFree(const Set& chosen, const ScoredModel& scored, Selection& selection) const {
    if (chosen.empty() || compare_.base().refit.noise_absorbs_misfit) return {};
    SINEW_ASSIGN(
        const FreeTermComparison found,
        CompareWithFreeTerms(compare_.problem(), compare_.candidates(), compare_.base(), scored, chosen));
    if (found.FreeTermIsBetter()) selection.better_term = found;
    return {};
  }

  void FindRemainingStructure(const ScoredModel& scored, bool nothing_chosen, Selection& selection) const {
    std::vector<std::pair<double, int>> unknown;
    double smallest = 1;
    for (std::size_t i = 0; i < scored.whitened.scores.size(); ++i) {
      const int c = scored.whitened.scores[i].candidate;
      const double p = scored.family.score_p_value[i];
      smallest = std::min(smallest, p);
      if (!compare_.candidate(c).known) unknown.emplace_back(p, c);
    }
    std::stable_sort(unknown.begin(), unknown.end(), [&](const auto& a, const auto& b) {
      if (a.first != b.first) return a.first < b.first;
      return scored.BestOf(a.second)->statistic > scored.BestOf(b.second)->statistic;
    });
    selection.line_left = scored.AlarmPValue() < smallest && scored.AlarmPValue() <= kFurtherLevel;
    selection.structure_left =
        nothing_chosen || smallest <= kFurtherLevel || selection.line_left || selection.better_term;
    for (const auto& [p, c] : unknown) {
      if (!selection.structure_left || (p > compare_.options().alarm_level && !selection.unknown.empty()))
        break;
      if (std::count(selection.unknown.begin(), selection.unknown.end(), c) > 0) continue;
      selection.unknown.push_back(c);
      selection.unknown_p_value.push_back(p);
    }
  }

  Refitter& refitter_;
  MisfitScale scale_;
  LikelihoodComparison compare_;
};

}  // namespace

Result<Selection> Select(const Problem& problem, Refitter& refitter, const std::vector<Candidate>& candidates,
                         const ScoredModel& base, const DiagnosisOptions& options) {
  return Selector(problem, refitter, candidates, base, options).Run();
}

}  // namespace sinew::diagnosis
