// Nuisance parameters of held-out trials (initial states, offsets): fitted to these trials, with all other
// parameters fixed.
#pragma once

#include "base/error.h"
#include "identify/problem.h"

namespace sinew::solvers {

/// The parameters [P] with the nuisance parameters of every held-out trial fitted to that trial alone, all
/// others as given. A held-out trial whose fit fails keeps its given values. @param parameters [P] Errors:
/// only a failed prediction at the given point.
Result<Vector> FitHeldOutNuisance(const Problem& problem, const Vector& parameters);

}  // namespace sinew::solvers
