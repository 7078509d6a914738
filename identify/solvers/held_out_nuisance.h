// Nuisance parameters of held-out trials (initial states, offsets): fitted to these trials, with all other
// parameters fixed.
#pragma once

#include <vector>

#include "base/error.h"
#include "identify/execution/fit_record.h"
#include "identify/problem.h"

namespace sinew::solvers {

/// The parameters [P] with the nuisance parameters of every held-out trial fitted to that trial alone, all
/// others as given. A held-out trial whose fit fails keeps its given values. @param parameters [P]
/// @param record of FitSetup, may be null @param earlier [P] each, other answers: where nuisance values have
/// priors, theirs are further starts. A search in growing windows (SearchInWindows) follows where a trial
/// costs more than with these answers, or if there are none: two models whose fits of a trial end at
/// different minima cannot be compared. Errors: only a failed prediction at the given point.
Result<Vector> FitHeldOutNuisance(const Problem& problem, const Vector& parameters, FitRecord* record,
                                  const std::vector<Vector>& earlier = {});

}  // namespace sinew::solvers
