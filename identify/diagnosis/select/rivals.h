// Alternatives to chosen causes, by likelihood.
#pragma once

#include <vector>

#include "identify/diagnosis/select/likelihood_comparison.h"

namespace sinew::diagnosis {

/// An alternative to a chosen cause that fits nearly as well in its place.
struct Rival {
  int candidate = 0;
  int instead_of = 0;      ///< a chosen candidate
  Refit refit;             ///< of the chosen set with this candidate in place of the cause
  double delta_lr = 0;     ///< likelihood ratio in favour of the chosen set
  double correlation = 0;  ///< of the two signatures, projected off the base columns
  /// If Selection::cross_validated: error of left-out data over that of the chosen set; delta_lr is NaN then.
  double left_out = 0;
};

/// Fits the sets that would do what all chosen causes do together (FindImitatingSets). None beside hundreds
/// of values with priors, where refits end at neighbouring minima.
/// @return the sets. Errors: those of Problem::Predict.
[[nodiscard]] Result<std::vector<std::vector<int>>> FitImitatingSets(LikelihoodComparison& compare,
                                                                     const std::vector<int>& chosen);

/// The rivals of each chosen cause, and of a pair those that replace both; those that fit best first.
/// @param compare holds the refits; more are made. @pre the chosen set is fitted
/// Errors: those of Problem::Predict.
[[nodiscard]] Result<std::vector<Rival>> FindRivals(LikelihoodComparison& compare,
                                                    const std::vector<int>& chosen);

/// Forward selection need not find the best set: a rival that explains more than a cause replaces it, and a
/// set that explains more than all causes replaces them, unless an effect does so only at the end of its
/// range, where it compensates for something else.
/// @param imitating from FitImitatingSets @return the better set; empty if there is none
[[nodiscard]] std::vector<int> BetterSet(const LikelihoodComparison& compare, const std::vector<int>& chosen,
                                         const std::vector<Rival>& rivals,
                                         const std::vector<std::vector<int>>& imitating);

}  // namespace sinew::diagnosis
