// Causes that data cannot tell from others after a selection by cross-validation: with another candidate in
// their place the model predicts left-out data nearly as well (within 5 %), or less well (within 25 %), but
// which of the two is chosen depends on the resample of the folds.
#pragma once

#include <vector>

#include "identify/diagnosis/diagnosis.h"
#include "identify/diagnosis/fit/refit.h"
#include "identify/diagnosis/score/candidate.h"
#include "identify/diagnosis/select/set_fitter.h"
#include "identify/diagnosis/select/unknown_terms.h"

namespace sinew::diagnosis {

/// A set with another candidate in place of a cause that predicts left-out data nearly as well.
struct Substitute {
  int cause = 0;
  int candidate = 0;
  double error = 0;  ///< of left-out data, as a share of that of the answer
  Refit refit;       ///< ordinary least squares
};

/// Whether the candidate is chosen without the cause in a tenth of the resamples or more, and hardly ever
/// (less than a tenth as often) together with it.
/// @param judged sets @param shares [judged] of the resamples of the folds in which each is chosen
[[nodiscard]] bool TakesTurns(int candidate, int cause, const std::vector<FittedSet>& judged,
                              const std::vector<double>& shares);

/// Of sets whose error on left-out data is known, those that differ from the answer by one cause and predict
/// as well (kSameError), or up to 25 % worse where the candidate takes turns with the cause (TakesTurns).
/// @param judged sets @param shares [judged] of the resamples of the folds in which each is chosen
/// @param tolerance of their fits to all data
/// @return best first
[[nodiscard]] std::vector<Substitute> FindSubstitutes(const std::vector<FittedSet>& judged,
                                                      const std::vector<double>& shares,
                                                      const FittedSet& answer, const Refitter& refitter,
                                                      double tolerance);

/// Those of `before` whose cause is left, judged again beside unknown terms.
/// @param fitter, refitter of models with terms. @param tolerance of their fits to all data
[[nodiscard]] std::vector<Substitute> SubstitutesBeside(const BesideUnknown& terms,
                                                        const std::vector<Candidate>& candidates,
                                                        const SetFitter& fitter, const Refitter& refitter,
                                                        std::vector<Substitute> before, double tolerance);

}  // namespace sinew::diagnosis
