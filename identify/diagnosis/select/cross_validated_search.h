// Selection by cross-validation, for misfits that dominate the noise: a noise model then absorbs the misfit,
// and likelihoods say little. A set of causes is judged by its prediction of trials that were left out of the
// fit (Stone 1974, J. R. Stat. Soc. B 36:111-147). Several sets are extended at a time (beam search), because
// a cause may improve the prediction only once another one is included. Trials, not conditions, are left out:
// without the condition that excites an effect its size cannot be estimated.
//
// The search makes hundreds of fits, so that only some of many trials are used in it; the set that is found
// is then fitted to all.
#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "identify/diagnosis/diagnosis.h"
#include "identify/diagnosis/fit/refit.h"
#include "identify/diagnosis/fit/trial_folds.h"
#include "identify/diagnosis/score/scored_model.h"
#include "identify/role_view.h"

namespace sinew::diagnosis {

/// True if, in some channel, the residual is strongly autocorrelated with a standard deviation far above that
/// of its innovations: instrument noise is not like this.
[[nodiscard]] bool MisfitDominatesNoise(const noise::NoiseModel& noise);

class CrossValidatedSearch {
 public:
  using Set = std::vector<int>;

  CrossValidatedSearch(const Problem& problem, const Refitter& refitter,
                       const std::vector<Candidate>& candidates, const DiagnosisOptions& options);

  /// True if there are at least two trials, so that they can be left out in turn.
  [[nodiscard]] bool possible() const { return folds_.size() > 1; }
  /// The problem with the training trials of the search: all, or twenty of them, spaced evenly in the order
  /// of their names.
  [[nodiscard]] const Problem& searched() const { return searched_; }
  /// The groups of these trials that are left out in turn.
  [[nodiscard]] const std::vector<TrialFold>& folds() const { return folds_; }

  /// Root mean square of the weighted residuals of left-out trials; infinite if a fit failed. @param start
  /// [P] from which every fit starts
  [[nodiscard]] double LeftOutError(const Set& released, const Vector& start) const;

  struct Outcome {
    Set released;
    Refit model;                          ///< ordinary least squares
    bool misfit_still_dominates = false;  ///< with the chosen causes MisfitDominatesNoise is still true
    double base_error = 0;                ///< RMS error of left-out trials by the base model
    double error = 0;                     ///< RMS error of left-out trials by this model
    /// Per cause: error of left-out trials with it as a share of that without it.
    std::vector<std::pair<int, double>> left_out_shares;
  };
  /// Searches for the set with the smallest error of left-out trials, starting from the base model; ends
  /// early if one cause suffices for MisfitDominatesNoise to become false. Errors: those of Problem::Predict.
  [[nodiscard]] Result<Outcome> Run(const ScoredModel& base);

 private:
  [[nodiscard]] std::vector<int> Promising(const ScoredModel& scored, const Set& have) const;
  struct Trial {
    Set released;
    Vector point;  ///< [P]
    double fitted_error = 0;
    double left_out_error = 0;
  };
  void Grow(const Trial& from, const ScoredModel& scored, std::vector<Trial>& made);
  void FitAll(std::vector<Trial>& trials, const std::vector<std::vector<Vector>>& starts) const;
  void Polish(const ScoredModel& base, std::vector<Trial>& sets) const;
  void LeaveOut(std::vector<Trial>& sets) const;
  [[nodiscard]] std::vector<Trial> OneLess(const Trial& of) const;
  [[nodiscard]] Result<Outcome> Conclude(Trial best, double base_error) const;
  [[nodiscard]] double Rows() const;

  const Problem& problem_;
  const Refitter& refitter_;
  const std::vector<Candidate>& candidates_;
  const DiagnosisOptions& options_;
  RoleView searched_;
  std::vector<TrialFold> folds_;
  int restarts_ = 0;  // random starts per set
  std::set<Set> seen_;
};

}  // namespace sinew::diagnosis
