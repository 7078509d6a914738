// The state that the steps of a diagnosis share: the problem, the candidates, the base model and its scores,
// and the selection. Each step reads it and adds its part.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "identify/diagnosis/diagnosis.h"
#include "identify/diagnosis/held_out_gain.h"
#include "identify/diagnosis/select/selection.h"

namespace sinew::diagnosis {

struct DiagnosisState {
  DiagnosisState(const Problem& of, const DiagnosisOptions& how)
      : problem(of), options(how), held_out(of, how.record, how.threads) {}

  const Problem& problem;
  const DiagnosisOptions& options;
  HeldOut held_out;
  std::vector<Candidate> candidates;
  std::unique_ptr<Refitter> refitter;
  ScoredModel base;
  Selection selection;
  /// Added weighted residuals [block of the layout -> samples] of the extended model, for an extension that
  /// is not a parameter, such as a drift.
  std::map<int, Vector> added;

  [[nodiscard]] const Candidate& candidate(int c) const { return candidates[static_cast<std::size_t>(c)]; }

  /// Loss of held-out residuals: the sum of squared innovations in units of their variance, or, if the misfit
  /// dominates the noise, the sum of squares.
  [[nodiscard]] double Loss(const std::vector<Vector>& residuals, const noise::NoiseModel& noise) const;

  /// DevianceDifference of this selection.
  [[nodiscard]] double Difference(const Refit& refit, const Refit& reference) const {
    return DevianceDifference(selection.found_by_search, refit, reference);
  }

  /// Covariance of the variables: under the refit's noise (Refitter::Covariance), or, if the misfit dominates
  /// the noise, by the jackknife over trials.
  [[nodiscard]] Result<Matrix> CovarianceOf(const Refit& refit) const;

  /// Variance of the variables [n] over the sets of causes that could have been chosen, about this refit
  /// (Buckland, Burnham, Augustin 1997, eq. 9): zero where causes were chosen by likelihood.
  [[nodiscard]] Vector SpreadOverSets(const Refit& refit) const;

  /// Refits with the procedure by which the causes were chosen. @param starts [P] each, not empty
  [[nodiscard]] Refit Fit(const std::vector<int>& released, const std::vector<Vector>& starts) const;
};

}  // namespace sinew::diagnosis
