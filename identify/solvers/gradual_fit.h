// A fit whose data count little at first and fully in the end: where many nuisance parameters with priors let
// a model follow the data along wrong paths, the solution is followed from the prior's to the data's.
#pragma once

#include <vector>

#include "base/linear_algebra.h"
#include "identify/least_squares.h"

namespace sinew::solvers {

/// Local searches one after the other, each from the end of the last, with the rows of the data multiplied by
/// the shares in turn; the priors always count fully (a homotopy in the noise level: Allgower, Georg,
/// Numerical Continuation Methods (1990), ch. 1). Only the last one, with share 1, converges.
/// @param fit without a transform; its transform is removed again @param start [n, in 0..1]
/// @param shares increasing, the last one 1 @param evaluations most of each search
/// @return [n]; the start where there is no prediction
[[nodiscard]] Vector FitGradually(LeastSquares& fit, const Vector& start, const std::vector<double>& shares,
                                  long evaluations);

}  // namespace sinew::solvers
