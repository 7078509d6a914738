// Where a local fit begins if it releases effects that have probe values: the period of a ripple, a Stribeck
// velocity.
#pragma once

#include <cstddef>
#include <functional>

#include "identify/least_squares.h"

namespace sinew::solvers {

/// At the null of such an effect the prediction does not depend on the parameter with probe values, so that a
/// search from there knows nothing of it; and along a period the cost has a minimum for each cycle that fits.
///
/// The other parameters are fitted without these effects. From there, at each probe value, the Gauss-Newton
/// step of all parameters of the fit says how far the cost would fall; the effect whose fall is the largest
/// is fitted from its best probe values, and so on with the effects that are left.
///
/// Effects one of whose free parameters starts neither at its null nor at a probe value are fitted as they
/// start: the request has stated where to begin. In fits whose nuisance parameters have priors all are.
/// Evaluations are not counted: one for each probe value as often as effects are left, and some hundred for
/// each effect.
/// @param start [n] @param stop whether to end early @param least_probes effects with fewer are fitted as
/// they start @return [n] a point of lower cost, or the start
[[nodiscard]] Vector ProbedStart(const LeastSquares& fit, const Vector& start,
                                 const std::function<bool()>& stop, std::size_t least_probes = 1);

}  // namespace sinew::solvers
