// A parameter that changes with time within a trial, to first order: no problem has such a term, but its own
// derivative tells what it would do.
#pragma once

#include <optional>

#include "identify/diagnosis/candidate.h"
#include "identify/diagnosis/held_out_gain.h"
#include "identify/diagnosis/refit.h"

namespace sinew {

struct DriftFit {
  double change = 0;     ///< of the parameter, half of begin to end [unit of the parameter]
  double std_error = 0;  ///< of `change`
  /// Held-out trials [blocks][samples], weighted, as HeldOut has them: before and after. Empty if there are
  /// none.
  std::vector<Vector> before;
  std::vector<Vector> after;
};

/// One linear step from a fitted model: its free parameters and the drift together, under its noise; held-out
/// trials get what the training trials say, and their own nuisance values.
/// @param noise one that has not swallowed the drift: Standing::noise, not that of the refit
/// Errors: the problem's own; the data do not tell the drift.
Result<DriftFit> FitDrift(const Problem& problem, const Refit& refit,
                          const std::vector<Candidate>& candidates, int candidate, const NoiseModel& noise);

}  // namespace sinew
