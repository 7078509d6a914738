// Selection by cross-validation, for misfits that dominate the noise: a noise model then absorbs the misfit,
// and likelihoods say little. A set of causes is judged by its prediction of data that were left out of the
// fit (Stone 1974, J. R. Stat. Soc. B 36:111-147): trials, or windows of time where there are few trials.
// Several sets are extended at a time (beam search), because a cause may improve the prediction only once
// another one is included. The error of a set is the geometric mean of the errors of the folds, so that no
// single fold decides; the answer is the smallest set whose error is near the least one.
//
// The search makes hundreds of fits (SetFitter); the set that is found is then fitted to all data.
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "identify/diagnosis/diagnosis.h"
#include "identify/diagnosis/fit/refit.h"
#include "identify/diagnosis/score/scored_model.h"
#include "identify/diagnosis/select/judged_sets.h"
#include "identify/diagnosis/select/misfit_scale.h"
#include "identify/diagnosis/select/set_fitter.h"
#include "identify/diagnosis/select/substitutes.h"
#include "identify/diagnosis/select/unknown_terms.h"

namespace sinew::diagnosis {

class CrossValidatedSearch {
 public:
  using Set = std::vector<int>;

  /// The arguments must outlive the search.
  CrossValidatedSearch(const Problem& problem, const Refitter& refitter,
                       const std::vector<Candidate>& candidates, const MisfitScale& scale,
                       const DiagnosisOptions& options);

  /// True if there are data that can be left out in turn.
  [[nodiscard]] bool possible() const { return fitter_.folds().size() > 1; }
  [[nodiscard]] const SetFitter& fitter() const { return fitter_; }

  /// The smallest error of left-out data with a number of causes.
  struct Step {
    Set released;
    double error = 0;
  };
  /// A set that could have been chosen.
  struct Resampled {
    Set released;
    Vector point;  ///< [P] fitted to the searched data
    double share = 0;
  };
  struct Outcome {
    Set released;              ///< the causes
    Refit model;               ///< ordinary least squares
    bool misfit_left = false;  ///< MisfitScale::Resembles is false with the chosen causes
    double base_error = 0;     ///< of left-out data by the base model
    double error = 0;          ///< of left-out data by this model
    /// Per cause: error of left-out data with it as a share of that without it.
    std::vector<std::pair<int, double>> left_out_shares;
    std::vector<Step> ladder;  ///< from no cause on, as far as the search went
    std::vector<Step> judged;  ///< every set whose error of left-out data is known
    /// Sets that are chosen in a share > 0 of resamples of the folds (ChosenShares) ...
    std::vector<Resampled> resampled;
    std::vector<std::pair<int, double>> chosen_shares;  ///< ... and each candidate's share
    std::vector<Substitute> substitutes;                ///< best first
    /// Unknown terms that are needed beside the causes. `released`, `model`, `error`, the shares and the
    /// substitutes are then those with the terms.
    std::optional<BesideUnknown> beside;
    std::shared_ptr<const Refitter> refitter;  ///< of models with terms, if there are any
    std::shared_ptr<const Outcome> plain;      ///< the outcome without the terms, if there are any
  };
  /// Searches for the smallest set that predicts left-out data nearly as well as the best one, starting from
  /// the base model; ends early if what one cause leaves may be noise (MisfitScale::Resembles), and if what a
  /// set leaves is no more than noise that is stated or visible (MisfitScale::IsNoMore). Nothing where the
  /// base model cannot be fitted without some part of the data: sets cannot be compared in this way. Errors:
  /// those of Problem::Predict; "interrupted".
  [[nodiscard]] Result<std::optional<Outcome>> Run(const ScoredModel& base);

 private:
  using Shares = std::vector<std::pair<int, double>>;
  [[nodiscard]] Result<std::vector<FittedSet>> GrownFrom(const std::vector<FittedSet>& beam,
                                                         const ScoredModel& base);
  void Shorten(std::vector<FittedSet>& made) const;
  [[nodiscard]] std::optional<FittedSet> Shrunk(FittedSet from);
  void Replace(const Set& idle, FittedSet acting);
  Status EndWith(std::vector<FittedSet> made);
  [[nodiscard]] bool LeavesOnlyNoise(const FittedSet& one) const;
  [[nodiscard]] bool LeavesMisfit(const FittedSet& one) const;
  [[nodiscard]] FittedSet Polished(const FittedSet& one) const;
  [[nodiscard]] Result<std::vector<FittedSet>> OneMore(const FittedSet& of) const;
  [[nodiscard]] Result<std::vector<FittedSet>> Exchanged(const FittedSet& of) const;
  [[nodiscard]] Result<std::vector<FittedSet>> Imitating(const FittedSet& of);
  [[nodiscard]] Result<FittedSet> Choose(Shares& shares);
  /// Returns the share of each judged set.
  std::vector<double> Resample(Outcome& outcome) const;
  [[nodiscard]] Result<std::optional<Outcome>> Conclude();
  Status AddUnknownTerms(const FittedSet& best, Outcome& outcome) const;
  void Tell(const FittedSet& best) const;

  const Problem& problem_;
  const Refitter& refitter_;
  const std::vector<Candidate>& candidates_;
  const MisfitScale& scale_;
  const DiagnosisOptions& options_;
  SetFitter fitter_;
  std::set<Set> seen_;       // made by GrownFrom, or by Imitating with a fair fit
  std::set<Set> imitating_;  // made by Imitating
  JudgedSets judged_;
};

}  // namespace sinew::diagnosis
