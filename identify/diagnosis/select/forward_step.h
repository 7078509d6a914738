// One step of forward selection by likelihood.
#pragma once

#include "identify/diagnosis/select/likelihood_comparison.h"

namespace sinew::diagnosis {

/// The best set with one more candidate (or, for the first step, also with two), if it is significant by
/// likelihood ratio or by its score; else empty. Where the refit of the best one contradicts its score, the
/// scores are distrusted and all candidates are refitted.
/// @param compare holds the refits; more are made
/// @param chosen causes so far, fitted @param scored that model
[[nodiscard]] std::vector<int> ForwardStep(LikelihoodComparison& compare, const std::vector<int>& chosen,
                                           const ScoredModel& scored);

}  // namespace sinew::diagnosis
