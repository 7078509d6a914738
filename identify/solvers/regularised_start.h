// A start for fits whose shared parameters lead a search astray while the curves of the trials are still far
// off.
#pragma once

#include <cstdint>

#include "base/random.h"
#include "identify/execution/evaluator.h"
#include "identify/solvers/continuation.h"

namespace sinew::solvers {

/// The fit with a Gaussian prior on every parameter that has none and is no nuisance, about its start: with a
/// deviation of 1 of its logarithm on a logarithmic scale, else of half its value, but at least a fiftieth of
/// its range. It is for a search only: without it, frictions may end at values at which the recorded motion
/// fits by a wrong law, whatever they begin at, and no curve near that motion leads back.
/// Source: regularisation that is taken away again (Allgower, Georg 1990, Numerical Continuation Methods).
[[nodiscard]] FitSetup Regularised(const FitSetup& setup, const Vector& start);

/// Another start of such priors: each parameter drawn from its own [P].
[[nodiscard]] Vector DrawnStart(const FitSetup& setup, const Vector& start, Random& random);

struct RegularisedSearch {
  NoiseSchedule schedule;
  double cost_tolerance = 1e-6;
  std::uint64_t seed = 1;
  int threads = 1;
};

/// Where a search by `continuation` with these priors ends, with stretches of the trials redrawn while they
/// hold [n]. Its evaluations are not recorded. @param parent whose limits of time and interruption hold
/// @param start [P]
[[nodiscard]] Vector RegularisedStart(const Evaluator& parent, const Vector& start,
                                      const RegularisedSearch& search);

}  // namespace sinew::solvers
