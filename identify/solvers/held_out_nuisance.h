// Trials that were never fitted still have initial states of their own: these are found, and nothing else.
#pragma once

#include "base/error.h"
#include "identify/problem.h"

namespace sinew {

/// The parameters with the nuisance values of every held-out trial fitted to that trial alone, all others as
/// given. A held-out trial whose fit fails keeps what it had.
/// @param parameters [P] Errors: none but the problem's own failures at the given point.
Result<Vector> FitHeldOutNuisance(const Problem& problem, const Vector& parameters);

}  // namespace sinew
