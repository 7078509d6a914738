// The choice among sets of causes by their errors of left-out data, and how firm it is: how often each set is
// chosen when the folds are drawn again with replacement (bootstrap of a selection: Buckland, Burnham,
// Augustin 1997, Biometrics 53:603-618).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace sinew::diagnosis {

/// Geometric mean, so that no single fold decides; infinite if there are none.
[[nodiscard]] double GeometricMean(const std::vector<double>& errors);

/// What the choice depends on.
struct JudgedSet {
  std::vector<int> released;        ///< candidates, increasing
  std::vector<double> fold_errors;  ///< [folds] of left-out data, > 0
  int at_bound = 0;                 ///< base parameters that a bound holds with these causes
  int rarity = 0;                   ///< sum over the causes of how rare they are in practice; 0: common
};

/// Whether left-out data need what one set has beyond another one: by rule 3 of ChooseSet.
/// @param with, without [folds] errors of left-out data; false if one is empty
[[nodiscard]] bool IsNeeded(const std::vector<double>& with, const std::vector<double>& without);

/// Index of the set that is chosen:
/// 1. the smallest of those whose error is at most 1.25 times the least one;
/// 2. among sets of that size within 5 % of the least error of that size: the one with the fewest base
/// parameters at a bound, then the one whose causes are most common, then the one with the least error;
/// 3. instead of it the best set of one cause less, as long as that, or the set without one of the causes,
/// costs less than 15 % of the smaller set's error, or, up to 20 %, improves 40 % of the folds.
/// @pre not empty
[[nodiscard]] std::size_t ChooseSet(const std::vector<JudgedSet>& sets);

/// Share of 1000 resamples of the folds in which each set is chosen [sets], sum 1.
/// @pre all sets have the same number of folds
[[nodiscard]] std::vector<double> ChosenShares(const std::vector<JudgedSet>& sets, std::uint64_t seed);

}  // namespace sinew::diagnosis
