// What sets of causes are compared by where the misfit is small: their deviance, at a price for each
// parameter.
#pragma once

#include <vector>

#include "identify/diagnosis/diagnosis.h"
#include "identify/diagnosis/fit/refit.h"
#include "identify/diagnosis/score/scored_model.h"
#include "identify/diagnosis/score/shortlist.h"
#include "identify/diagnosis/select/refit_cache.h"

namespace sinew::diagnosis {

/// Likelihood ratio that each step from common to rare counts between a cause and its rival: far below
/// SetWidth.
constexpr double kByOccurrence = 0.5;

/// Family-wise level of causes after the first, and of what the final model leaves.
constexpr double kFurtherLevel = 0.02;

/// A likelihood ratio that differs from its score by this share and by more than kSetWidth contradicts the
/// linear model of the score.
constexpr double kContradictingShare = 0.3;

/// Largest penalised likelihood ratio at which a rival still counts as not distinguishable from this model.
[[nodiscard]] double SetWidth(const Refit& model);

class LikelihoodComparison {
 public:
  using Set = std::vector<int>;

  /// The arguments must outlive it.
  LikelihoodComparison(const Problem& problem, const Refitter& refitter,
                       const std::vector<Candidate>& candidates, const ScoredModel& base,
                       const DiagnosisOptions& options);

  [[nodiscard]] const Problem& problem() const { return problem_; }
  [[nodiscard]] const Refitter& refitter() const { return refitter_; }
  [[nodiscard]] const std::vector<Candidate>& candidates() const { return candidates_; }
  [[nodiscard]] const Candidate& candidate(int c) const { return candidates_[static_cast<std::size_t>(c)]; }
  [[nodiscard]] const ScoredModel& base() const { return base_; }
  [[nodiscard]] const DiagnosisOptions& options() const { return options_; }
  [[nodiscard]] const Shortlist& shortlist() const { return shortlist_; }

  /// The models that are compared.
  [[nodiscard]] RefitCache& refits() { return refits_; }
  [[nodiscard]] const RefitCache& refits() const { return refits_; }
  [[nodiscard]] const Refit& at(const Set& released) const { return refits_.at(released); }
  /// A fitted set's scores, at kFurtherLevel. Errors: those of Problem::Predict.
  [[nodiscard]] Result<ScoredModel> ScoresOf(const Set& released) const;

  /// The causes were found by a search over sets: deviances are compared as after a search
  /// (DevianceDifference), and further causes must gain enough (GainsTooLittle).
  void CompareAsAfterSearch();
  [[nodiscard]] bool found_by_search() const { return found_by_search_; }
  /// Refits contradict the scores: from now on all candidates are refitted, and to their end.
  void DistrustScores();
  [[nodiscard]] bool scores_contradicted() const { return scores_contradicted_; }

  /// Candidates that are worth a refit beside a model; increasing.
  [[nodiscard]] std::vector<int> Singles(const ScoredModel& scored) const;

  /// kPerParameter for each parameter of these candidates.
  [[nodiscard]] double Price(const Set& released) const;
  /// Deviance of a refit less that of another one.
  [[nodiscard]] double Difference(const Refit& refit, const Refit& reference) const {
    return refits_.Difference(refit, reference);
  }
  /// The same of the deviances with their prices.
  [[nodiscard]] double Penalised(const Refit& refit, const Refit& reference) const;
  /// ... and kByOccurrence: of models that data do not distinguish, the one whose causes are more common in
  /// practice is lower.
  [[nodiscard]] double PenalisedByOccurrence(const Refit& refit, const Refit& reference) const;
  /// True if the deviance of `smaller` is so little above that of `larger` that further causes are not worth
  /// a name: always false unless a search has found the causes, and where both leave no more than noise of
  /// the inputs.
  [[nodiscard]] bool GainsTooLittle(const Refit& larger, const Refit& smaller) const;

  /// Family-wise p-value of the likelihood ratio of the candidates `more` together.
  [[nodiscard]] double PValue(double delta_lr, const Set& more) const;

  /// Of two signatures at the base model, at the probes with the largest statistics.
  [[nodiscard]] double Correlation(int a, int b) const;

  /// True for a set of the same size as that of `best` with fewer parameters, nearly the same trace and
  /// hardly a worse fit: the simpler law is then named.
  [[nodiscard]] bool IsSimplerDouble(const Set& released, const Refit& best) const;

 private:
  [[nodiscard]] double Rarity(const Refit& refit) const;

  const Problem& problem_;
  const Refitter& refitter_;
  const std::vector<Candidate>& candidates_;
  const ScoredModel& base_;
  const DiagnosisOptions& options_;
  RefitCache refits_;
  Shortlist shortlist_;
  bool scores_contradicted_ = false;
  bool found_by_search_ = false;
};

}  // namespace sinew::diagnosis
