#include "identify/diagnosis/select/selection.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "identify/diagnosis/score/shortlist.h"
#include "identify/diagnosis/select/cross_validated_selection.h"
#include "identify/diagnosis/select/refit_cache.h"
#include "identify/statistics/distributions.h"

namespace sinew::diagnosis {
namespace {

constexpr int kMaxCauses = 5;
constexpr int kMaxExchanges = 8;  // each lowers the deviance, so that the loop would end without this limit
constexpr double kFurtherLevel = 0.02;  // family-wise level after the first cause
// Least fall of the deviance per sample by a further cause, after a search by cross-validation: 2 % of the
// residual's deviation. Where a misfit dominated the noise, no named law is exact to the last thousandth of
// it, and thousands of samples make what that leaves significant.
constexpr double kLeastGainPerSample = 0.04;
constexpr double kParsimony = 10.8;     // 0.999 quantile of chi-squared with one degree of freedom
constexpr double kDouble = 0.97;        // correlation of traces above which they count as equal
constexpr double kNearUnitRoot = 0.97;  // root of the noise model above which it may describe an effect
// Relative error of a score by its linearity, per square root of the score: 1 % at size 3, 4 % at size 12.
constexpr double kCurvature = 1e-3;
// A refit that ends so many standard errors from the estimate of its score, or whose likelihood ratio differs
// from the score by this share and by more than kSetWidth, contradicts the linear model.
constexpr double kContradictingErrors = 2.5;
constexpr double kContradictingShare = 0.3;

class Selector {
 public:
  Selector(const Problem& problem, const Refitter& refitter, const std::vector<Candidate>& candidates,
           const ScoredModel& base, const DiagnosisOptions& options)
      : problem_(problem),
        refitter_(refitter),
        candidates_(candidates),
        base_(base),
        options_(options),
        scale_(problem),
        cache_(refitter, candidates, base.refit, options),
        shortlist_(candidates, base) {}

  Result<Selection> Run() {
    Selection selection;
    selection.family_p_value = base_.AlarmPValue();
    selection.alarm = selection.family_p_value <= options_.alarm_level;
    selection.model = base_.refit;
    if (!selection.alarm && !NoiseMayAbsorbEffect()) return selection;

    std::vector<int> chosen;
    ScoredModel scored = base_;
    if (base_.refit.noise_absorbs_misfit || scale_.Dominates(base_.refit.noise)) {
      SINEW_TRY(SearchByCrossValidation(selection, chosen));
      if (selection.cross_validated) return selection;
      found_by_search_ = !chosen.empty();
      selection.found_by_search = found_by_search_;
      if (found_by_search_) {
        cache_.CompareAsAfterSearch();
        selection.alarm = true;
        selection.family_p_value = std::min(selection.family_p_value, options_.alarm_level);
        SINEW_ASSIGN(scored,
                     ScoreModel(problem_, candidates_, cache_.at(chosen), kFurtherLevel, options_.seed));
      }
    }
    while (static_cast<int>(chosen.size()) < kMaxCauses &&
           (chosen.empty() || scored.family.p_value <= kFurtherLevel)) {
      SINEW_ASSIGN(const std::vector<int> next, Extend(chosen, scored));
      if (next.empty()) break;
      if (!selection.alarm) {
        selection.alarm = true;
        selection.family_p_value = options_.alarm_level;
      }
      chosen = next;
      SINEW_ASSIGN(scored,
                   ScoreModel(problem_, candidates_, cache_.at(chosen), kFurtherLevel, options_.seed));
    }
    for (const auto& [released, refit] : cache_.all()) {
      if (released.size() == 1 && refit.usable()) selection.tried.push_back(refit);
    }
    if (!selection.alarm) return selection;
    Eliminate(chosen);
    SINEW_ASSIGN(const bool unknown_is_better, UnknownTermFitsBetter(chosen));
    if (unknown_is_better) chosen.clear();
    for (int exchanges = 0;; ++exchanges) {
      selection.causes.clear();
      selection.rivals.clear();
      Judge(chosen, selection);
      if (const ChosenCause* worse = LowersTheLikelihood(selection)) {
        chosen = Without(chosen, worse->candidate);
        continue;
      }
      SINEW_TRY(FindRivals(chosen, selection));
      const Set better = BetterRival(chosen, selection);
      if (better.empty() || exchanges >= kMaxExchanges) break;
      chosen = better;
      Eliminate(chosen);
    }
    SINEW_ASSIGN(scored, ScoreModel(problem_, candidates_, cache_.at(chosen), kFurtherLevel, options_.seed));
    selection.model = cache_.at(chosen);
    // Significant it may still be: an input that was recorded in a loop holds the noise of what was fed back.
    if (found_by_search_ && !chosen.empty() && scale_.IsNoise(selection.model.noise)) return selection;
    SINEW_TRY(CompareWithFree(chosen, scored, selection));
    FindRemainingStructure(scored, chosen.empty(), selection);
    return selection;
  }

 private:
  using Set = std::vector<int>;

  // If what one known cause leaves may be noise, the steps by likelihood are more powerful. If it takes
  // several, these steps continue from them; if a misfit is left, cross-validation decides.
  Status SearchByCrossValidation(Selection& selection, Set& chosen) {
    CrossValidatedSearch search(problem_, refitter_, candidates_, scale_, options_);
    if (!search.possible()) return {};
    SINEW_ASSIGN(auto found, search.Run(base_));
    if (!found.misfit_left && found.released.size() > 1) {
      chosen = found.released;
      std::sort(chosen.begin(), chosen.end());
      cache_.Fit({{chosen, {found.model.point}}});
      if (!cache_.at(chosen).usable()) chosen.clear();
    }
    if (!found.misfit_left || (found.released.empty() && !found.beside)) return {};
    selection.alarm = true;
    selection.cross_validated = true;
    selection.family_p_value = std::min(selection.family_p_value, options_.alarm_level);
    selection.structure_left = true;
    TakeOver(search, std::move(found), candidates_, base_, selection);
    return {};
  }

  // Coloured noise with a root near one, or a process deviation far above that of its innovations, may be an
  // effect that the noise model has absorbed.
  [[nodiscard]] bool NoiseMayAbsorbEffect() const {
    const auto& channels = base_.refit.noise.channels;
    return std::any_of(channels.begin(), channels.end(), [](const noise::ChannelNoiseModel& channel) {
      return channel.LargestRoot() > kNearUnitRoot;
    });
  }

  [[nodiscard]] double Samples() const { return static_cast<double>(base_.design.residual.size()); }

  [[nodiscard]] double Price(const Set& released) const {
    double parameters = 0;
    for (const int c : released)
      parameters += static_cast<double>(candidates_[static_cast<std::size_t>(c)].parameters.size());
    return kPerParameter * parameters;
  }
  [[nodiscard]] double Difference(const Refit& refit, const Refit& reference) const {
    return cache_.Difference(refit, reference);
  }
  // Penalised deviance less that of the reference.
  [[nodiscard]] double Penalised(const Refit& refit, const Refit& reference) const {
    return Difference(refit, reference) + Price(refit.released) - Price(reference.released);
  }
  // Of models that data do not distinguish, the one whose causes are more common in practice.
  [[nodiscard]] double PenalisedByOccurrence(const Refit& refit, const Refit& reference) const {
    return Penalised(refit, reference) + kByOccurrence * (Rarity(refit) - Rarity(reference));
  }
  [[nodiscard]] double Rarity(const Refit& refit) const {
    double rarity = 0;
    for (const int c : refit.released)
      rarity += static_cast<double>(candidates_[static_cast<std::size_t>(c)].occurrence);
    return rarity;
  }

  // Whether the refit with one more candidate contradicts the linear model from which it was chosen.
  [[nodiscard]] bool ContradictsScore(const ScoredModel& scored, const Refit& refit, int c) const {
    const Score* score = scored.BestOf(c);
    if (!refit.usable() || score == nullptr) return false;
    const double gained = scored.refit.deviance - refit.deviance;
    const double difference = std::abs(gained - score->statistic);
    if (!refit.converged || difference > std::max(kSetWidth, kContradictingShare * score->statistic))
      return true;
    const Candidate& candidate = candidates_[static_cast<std::size_t>(c)];
    const auto probe = static_cast<std::size_t>(score->probe);
    const auto covariance = refitter_.Covariance(refit);
    if (IsScoredBySecant(candidate, probe) || !covariance) return false;
    const LeastSquares fit(problem_, *refit.setup);
    const Vector estimate = fit.Variables(RefitStarts(scored, candidates_, c).front());
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

  [[nodiscard]] std::vector<int> Singles(const ScoredModel& scored) const {
    return scores_contradicted_ ? shortlist_.All() : shortlist_.Singles(scored);
  }

  // Family-wise p-value of the likelihood ratio of the candidates `more` together.
  [[nodiscard]] double RefitPValue(double delta_lr, const Set& more) const {
    double degrees = 0;
    bool primary = true;
    bool positive = true;
    for (const int c : more) {
      const Candidate& candidate = candidates_[static_cast<std::size_t>(c)];
      degrees += static_cast<double>(candidate.parameters.size());
      primary = primary && candidate.primary();
      const Parameter& p =
          base_.refit.setup->parameters[static_cast<std::size_t>(candidate.parameters.front())];
      positive = positive && (p.null_value <= p.lower || p.null_value >= p.upper);
    }
    double p = statistics::ChiSquaredUpperTail(std::max(0.0, delta_lr), degrees);
    if (positive && degrees == 1) p *= 0.5;
    if (!primary) p *= 5;
    return base_.family.FamilyPValue(std::min(1.0, p));
  }

  // Fits the sets with one more candidate, and pairs at the first cause; adds them to `wanted`.
  const Refit* FitExtensions(const Set& chosen, const ScoredModel& scored,
                             std::map<Set, std::vector<Vector>>& wanted) {
    for (const int c : Singles(scored)) {
      if (std::find(chosen.begin(), chosen.end(), c) == chosen.end())
        wanted[With(chosen, c)] = RefitStarts(scored, candidates_, c);
    }
    if (chosen.size() == 1) AddPairs(wanted);
    cache_.Fit(wanted);
    const Refit* best = nullptr;
    for (const auto& [released, starts] : wanted) {
      const Refit& refit = cache_.at(released);
      if (refit.usable() && (best == nullptr || Penalised(refit, *best) < 0)) best = &refit;
    }
    return best;
  }

  // The best set with one more candidate (or, for the first step, also with two), if it is significant; else
  // empty.
  Result<Set> Extend(const Set& chosen, const ScoredModel& scored) {
    std::map<Set, std::vector<Vector>> wanted;
    const Refit* best = FitExtensions(chosen, scored, wanted);
    if (best == nullptr) return Set();
    if (!scores_contradicted_ && best->released.size() == chosen.size() + 1) {
      Set added;
      std::set_difference(best->released.begin(), best->released.end(), chosen.begin(), chosen.end(),
                          std::back_inserter(added));
      // Beside hundreds of values that follow the data refits end at neighbouring minima: those of all
      // candidates would say no more than their scores, and take hours.
      const bool many_minima = base_.refit.noise.CountsPriors();
      scores_contradicted_ = !many_minima && ContradictsScore(scored, *best, added.front());
      if (scores_contradicted_) {
        cache_.ContinueRefits();
        best = FitExtensions(chosen, scored, wanted);
      }
    }
    for (const auto& [released, starts] : wanted) {
      if (IsSimplerDouble(released, *best)) best = &cache_.at(released);
    }
    const double gained = cache_.at(chosen).deviance - best->deviance;
    if (found_by_search_ && -Difference(*best, cache_.at(chosen)) < kLeastGainPerSample * Samples())
      return Set();
    Set more;
    const std::size_t extra = best->released.size() - chosen.size();
    for (const int c : best->released) {
      if (std::find(chosen.begin(), chosen.end(), c) == chosen.end()) more.push_back(c);
    }
    if (more.size() > extra) more.resize(std::max<std::size_t>(extra, 1));
    const double level = chosen.empty() ? options_.alarm_level : kFurtherLevel;
    const bool by_score = scored.family.p_value <= level && BestIsKnown(scored);
    if (!by_score && RefitPValue(gained, more) > level) return Set();
    if (Penalised(*best, cache_.at(chosen)) >= 0) return Set();
    return best->released;
  }

  // True for a set of the same size with fewer parameters, nearly the same trace and hardly a worse fit: the
  // simpler law is then named.
  [[nodiscard]] bool IsSimplerDouble(const Set& released, const Refit& best) const {
    const Refit& refit = cache_.at(released);
    if (!refit.usable() || released.size() != best.released.size() || Price(released) >= Price(best.released))
      return false;
    if (Difference(refit, best) > kParsimony) return false;
    Set own;
    Set other;
    std::set_difference(released.begin(), released.end(), best.released.begin(), best.released.end(),
                        std::back_inserter(own));
    std::set_difference(best.released.begin(), best.released.end(), released.begin(), released.end(),
                        std::back_inserter(other));
    return own.size() == 1 && Correlation(own.front(), other.front()) > kDouble;
  }

  // True if the most significant score is that of a library effect, not of a discrepancy term.
  [[nodiscard]] bool BestIsKnown(const ScoredModel& scored) const {
    double known = 1;
    for (std::size_t i = 0; i < scored.whitened.scores.size(); ++i) {
      const Score& score = scored.whitened.scores[i];
      if (candidates_[static_cast<std::size_t>(score.candidate)].known)
        known = std::min(known, scored.family.score_p_value[i]);
    }
    return known <= scored.family.level;
  }

  void AddPairs(std::map<Set, std::vector<Vector>>& wanted) const {
    for (const auto& [a, b] : shortlist_.Pairs()) {
      Vector start = RefitStarts(base_, candidates_, a).front();
      const Vector second = RefitStarts(base_, candidates_, b).front();
      for (const int index : candidates_[static_cast<std::size_t>(b)].parameters)
        start[index] = second[index];
      wanted[With({a}, b)].push_back(std::move(start));
    }
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
    if (chosen.empty() || base_.refit.noise_absorbs_misfit || found_by_search_) return false;
    std::vector<const Score*> known;
    double parameters = 0;
    for (const int c : chosen) {
      const Score* score = base_.BestOf(c);
      if (score != nullptr) known.push_back(score);
      parameters += static_cast<double>(candidates_[static_cast<std::size_t>(c)].parameters.size());
    }
    const double linear = JointStatistic(base_.whitened, known);
    const double refitted = -Difference(cache_.at(chosen), cache_.at({}));
    const double explained = std::max(linear, refitted) - kPerParameter * parameters;
    const double neglected = kCurvature * std::pow(std::max(linear, 0.0), 1.5);
    for (const Score& score : base_.whitened.scores) {
      if (candidates_[static_cast<std::size_t>(score.candidate)].known) continue;
      const double price = kPerParameter * (static_cast<double>(score.directions.size()) + score.searched);
      if (score.statistic - price <= explained + neglected + SetWidth(base_.refit)) continue;
      if (std::abs(linear - refitted) <= kContradictingShare * std::max(linear, refitted)) return true;
      SINEW_ASSIGN(const ScoredModel left,
                   ScoreModel(problem_, candidates_, cache_.at(chosen), kFurtherLevel, options_.seed));
      return left.AlarmPValue() <= kFurtherLevel;
    }
    return false;
  }

  // Backward elimination of causes whose likelihood ratio is below their penalty.
  void Eliminate(Set& chosen) {
    bool again = chosen.size() > 1;
    while (again) {
      again = false;
      std::map<Set, std::vector<Vector>> wanted;
      const Vector& point = cache_.at(chosen).point;
      for (const int c : chosen) {
        Vector start = point;
        for (const int index : candidates_[static_cast<std::size_t>(c)].parameters)
          start[index] = base_.refit.point[index];
        wanted[Without(chosen, c)] = {start};
      }
      cache_.Fit(wanted);
      const Set* best = nullptr;
      for (const auto& [released, starts] : wanted) {
        if (cache_.at(released).usable() &&
            (best == nullptr || Penalised(cache_.at(released), cache_.at(*best)) < 0))
          best = &released;
      }
      if (best == nullptr) return;
      Set gone;
      for (const int c : chosen) {
        if (std::find(best->begin(), best->end(), c) == best->end()) gone.push_back(c);
      }
      if (found_by_search_ &&
          Difference(cache_.at(*best), cache_.at(chosen)) >= kLeastGainPerSample * Samples())
        return;
      const double lost = cache_.at(*best).deviance - cache_.at(chosen).deviance;
      if (RefitPValue(lost, gone) <= options_.alarm_level) return;
      chosen = *best;
      again = chosen.size() > 1;
    }
  }

  void Judge(const Set& chosen, Selection& selection) {
    const Refit& model = cache_.at(chosen);
    for (const int c : chosen) {
      const Refit* without = cache_.FindUsable(Without(chosen, c));
      ChosenCause cause;
      cause.candidate = c;
      if (without != nullptr) cause.delta_lr = Difference(*without, model);
      cause.p_value = RefitPValue(cause.delta_lr, {c});
      if (chosen.size() == 1) {
        for (std::size_t i = 0; i < base_.whitened.scores.size(); ++i) {
          if (base_.whitened.scores[i].candidate == c)
            cause.p_value = std::min(cause.p_value, base_.family.score_p_value[i]);
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

  // The rivals of each cause.
  Status FindRivals(const Set& chosen, Selection& selection) {
    for (const int c : chosen) {
      const Set rest = Without(chosen, c);
      std::optional<ScoredModel> made;
      if (!rest.empty()) {
        if (cache_.FindUsable(rest) == nullptr) continue;
        SINEW_ASSIGN(made, ScoreModel(problem_, candidates_, cache_.at(rest), kFurtherLevel, options_.seed));
      }
      const ScoredModel& scored = made ? *made : base_;
      std::map<Set, std::vector<Vector>> wanted;
      for (const int other : Singles(scored)) {
        if (std::find(chosen.begin(), chosen.end(), other) == chosen.end())
          wanted[With(rest, other)] = RefitStarts(scored, candidates_, other);
      }
      cache_.Fit(wanted);
      for (const auto& [released, starts] : wanted) {
        AddRival(chosen, c, released, selection);
      }
    }
    // Rivals that replace both causes of a pair.
    if (chosen.size() == 2) {
      for (const auto& [released, refit] : cache_.all()) {
        const bool disjoint =
            released.size() == 2 && std::none_of(released.begin(), released.end(), [&](int c) {
              return std::find(chosen.begin(), chosen.end(), c) != chosen.end();
            });
        if (disjoint) AddRivalPair(chosen, released, selection);
      }
    }
    std::stable_sort(selection.rivals.begin(), selection.rivals.end(),
                     [](const Rival& a, const Rival& b) { return a.delta_lr < b.delta_lr; });
    return {};
  }

  // Forward selection need not find the best set: a rival that explains more than a cause replaces it, unless
  // it does so only at the end of its range, where it compensates for something else. Empty: there is no such
  // rival.
  [[nodiscard]] Set BetterRival(const Set& chosen, const Selection& selection) const {
    const Refit* best = &cache_.at(chosen);
    for (const Rival& rival : selection.rivals) {
      if (PenalisedByOccurrence(rival.refit, *best) < 0 && !IsSimplerDouble(chosen, rival.refit) &&
          !EndsAtABound(rival.refit, rival.candidate))
        best = &rival.refit;
    }
    return best->released == chosen ? Set() : best->released;
  }

  [[nodiscard]] bool EndsAtABound(const Refit& refit, int c) const {
    const auto& parameters = candidates_[static_cast<std::size_t>(c)].parameters;
    return std::any_of(parameters.begin(), parameters.end(), [&](int index) {
      const Parameter& p = refit.setup->parameters[static_cast<std::size_t>(index)];
      const double value = refit.point[index];
      return value != p.null_value && (value <= p.lower || value >= p.upper);
    });
  }

  void AddRival(const Set& chosen, int cause, const Set& released, Selection& selection) const {
    const Refit& refit = cache_.at(released);
    const Refit& model = cache_.at(chosen);
    if (!refit.usable() || Penalised(refit, model) > SetWidth(model)) return;
    for (const int c : released) {
      if (std::find(chosen.begin(), chosen.end(), c) == chosen.end())
        selection.rivals.push_back({c, cause, refit, Difference(refit, model), Correlation(c, cause)});
    }
  }

  void AddRivalPair(const Set& chosen, const Set& released, Selection& selection) const {
    const Refit& refit = cache_.at(released);
    const Refit& model = cache_.at(chosen);
    if (!refit.usable() || Penalised(refit, model) > SetWidth(model)) return;
    for (const int c : released) {
      const bool known = std::any_of(selection.rivals.begin(), selection.rivals.end(),
                                     [&](const Rival& rival) { return rival.candidate == c; });
      if (known) continue;
      const int like = Correlation(c, chosen[0]) >= Correlation(c, chosen[1]) ? chosen[0] : chosen[1];
      selection.rivals.push_back({c, like, refit, Difference(refit, model), Correlation(c, like)});
    }
  }

  // Correlation of two signatures at the base model, at the probes with the largest statistics.
  [[nodiscard]] double Correlation(int a, int b) const {
    const Score* first = base_.BestOf(a);
    const Score* second = base_.BestOf(b);
    return first != nullptr && second != nullptr ? base_.whitened.Correlation(*first, *second) : 0;
  }

  Status CompareWithFree(const Set& chosen, const ScoredModel& scored, Selection& selection) const {
    if (chosen.empty() || base_.refit.noise_absorbs_misfit) return {};
    SINEW_ASSIGN(const FreeTermComparison found,
                 CompareWithFreeTerms(problem_, candidates_, base_, scored, chosen));
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
      if (!candidates_[static_cast<std::size_t>(c)].known) unknown.emplace_back(p, c);
    }
    std::stable_sort(unknown.begin(), unknown.end(), [&](const auto& a, const auto& b) {
      if (a.first != b.first) return a.first < b.first;
      return scored.BestOf(a.second)->statistic > scored.BestOf(b.second)->statistic;
    });
    selection.line_left = scored.AlarmPValue() < smallest && scored.AlarmPValue() <= kFurtherLevel;
    selection.structure_left =
        nothing_chosen || smallest <= kFurtherLevel || selection.line_left || selection.better_term;
    for (const auto& [p, c] : unknown) {
      if (!selection.structure_left || (p > options_.alarm_level && !selection.unknown.empty())) break;
      if (std::count(selection.unknown.begin(), selection.unknown.end(), c) > 0) continue;
      selection.unknown.push_back(c);
      selection.unknown_p_value.push_back(p);
    }
  }

  const Problem& problem_;
  const Refitter& refitter_;
  const std::vector<Candidate>& candidates_;
  const ScoredModel& base_;
  const DiagnosisOptions& options_;
  MisfitScale scale_;
  RefitCache cache_;
  Shortlist shortlist_;
  bool scores_contradicted_ = false;  // by a refit: then all candidates are refitted
  bool found_by_search_ = false;      // several causes, by cross-validation
};

}  // namespace

double SetWidth(const Refit& model) {
  return model.noise.IsColoured() ? kSetWidthColoured : kSetWidth;
}

Result<Selection> Select(const Problem& problem, const Refitter& refitter,
                         const std::vector<Candidate>& candidates, const ScoredModel& base,
                         const DiagnosisOptions& options) {
  return Selector(problem, refitter, candidates, base, options).Run();
}

}  // namespace sinew::diagnosis
