// Unknown terms beside the causes that a search by cross-validation has chosen. Where these leave more than
// noise, something is missing that no known effect is; the known effects nearest to it then take part of its
// place. A term that stands for no effect (DiscrepancyTerm) takes that place, and a cause that is no longer
// needed beside it may have been an imitation of it.
#pragma once

#include <optional>
#include <vector>

#include "identify/diagnosis/select/set_fitter.h"

namespace sinew::diagnosis {

struct BesideUnknown {
  FittedSet set;                     ///< causes and terms
  std::vector<int> terms;            ///< in the order in which they were added, at least one
  std::vector<int> causes;           ///< increasing
  std::vector<double> cause_shares;  ///< [causes] error of left-out data with it over that without it
  std::vector<int> imitations;       ///< causes of the answer that left-out data do not need beside the terms
};

/// The setup with a prior of mean zero for every weight of a term, so weak that it decides only what the data
/// leave open: knots without data, and what a base parameter or an effect does as well (a constant, a
/// straight line). A curve of a third of its range costs 1e-4 of the squared residual.
/// @param residual its norm, > 0
[[nodiscard]] FitSetup WithShrunkTerms(FitSetup setup, const std::vector<Candidate>& candidates,
                                       double residual);

/// Adds at most two terms to a set of causes, each if left-out data need it (IsNeeded) beside the causes;
/// after each, takes out the causes that are not needed beside it, and adds known effects that are needed
/// now. Nothing if no term is needed.
/// @param fitter of WithShrunkTerms @param answer fitted and left out @param most causes
/// Errors: those of Problem::Predict.
[[nodiscard]] Result<std::optional<BesideUnknown>> FindUnknownTerms(const SetFitter& fitter,
                                                                    const std::vector<Candidate>& candidates,
                                                                    const FittedSet& answer,
                                                                    std::size_t most);

}  // namespace sinew::diagnosis
