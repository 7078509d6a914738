// An unknown term to first order: a parameter that changes with time within a trial, which no problem has but
// whose own derivative tells what it would do; or a curve with many knots, of which the data see some badly.
#pragma once

#include <vector>

#include "identify/diagnosis/fit/refit.h"
#include "identify/diagnosis/held_out_gain.h"
#include "identify/diagnosis/score/candidate.h"

namespace sinew::diagnosis {

struct LinearTerm {
  Vector values;         ///< [K] of a curve at its knots; of a drift one: half of begin to end [its unit]
  Vector deviations;     ///< [K] standard deviations of `values`
  double shrinkage = 0;  ///< prior deviation of a curve's values [its unit]; infinite for a drift
  std::vector<Vector> train;  ///< training blocks after [blocks][samples], weighted
  /// Held-out trials [blocks][samples], weighted, as HeldOut has them: before and after. Empty if there are
  /// none.
  std::vector<Vector> before;
  std::vector<Vector> after;
};

/// One linear step from a fitted model: its free parameters and the term together, under its noise; held-out
/// trials get what the training trials say, and their own nuisance values.
///
/// A curve's values are shrunk towards zero as a random effect (Laird, Ware 1982), with the deviation that
/// makes the data most likely: knots that the data hardly see stay at zero instead of going wild.
/// @param candidate an unknown term @param noise one that has not swallowed the term: ScoredModel::noise, not
/// that of the refit. Errors: the problem's own; the data do not tell the term.
Result<LinearTerm> FitLinearTerm(const Problem& problem, const Refit& refit, const Candidate& candidate,
                                 const noise::NoiseModel& noise);

}  // namespace sinew::diagnosis
