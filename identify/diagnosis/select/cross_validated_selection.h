// What a cross-validated search found, as the selection of a diagnosis.
#pragma once

#include <vector>

#include "identify/diagnosis/select/cross_validated_search.h"
#include "identify/diagnosis/select/selection.h"

namespace sinew::diagnosis {

/// Replaces causes, rivals, model, ladder and folds of the selection. Likelihood ratios are not valid where a
/// misfit dominates the noise: those of causes and rivals are NaN.
/// @param base scores of the base model
void TakeOver(const CrossValidatedSearch& search, CrossValidatedSearch::Outcome found,
              const std::vector<Candidate>& candidates, const ScoredModel& base, Selection& selection);

}  // namespace sinew::diagnosis
