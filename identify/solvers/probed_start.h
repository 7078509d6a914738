// Where a local fit begins if it releases effects that have probe values: the period of a ripple, a Stribeck
// velocity.
#pragma once

#include <cstddef>
#include <functional>

#include "identify/least_squares.h"

namespace sinew::solvers {

struct ProbedSearch {
  std::function<bool()> stop;                ///< whether to end early
  std::function<void(const Vector&)> found;  ///< called with points [n] on the way; may be empty
  std::size_t least_probes = 1;              ///< effects with fewer values are fitted as they start
};

/// Whether ProbedStart has effects to place.
[[nodiscard]] bool HasProbes(const FitSetup& setup, std::size_t least_probes = 1);

/// At the null of such an effect the prediction does not depend on the parameter with probe values, so that a
/// search from there does not determine it; and along a period the cost has many local minima.
///
/// The other parameters are fitted without these effects. From there, at each probe value, the Gauss-Newton
/// step of all parameters of the fit predicts how far the cost falls; the effect whose fall is the largest is
/// fitted from its best probe values, and so on with the effects that are left.
///
/// Effects for one of whose parameters the request states a start (FitSetup::stated_starts) are fitted as
/// they start. So are all effects of fits whose nuisance parameters have priors. Evaluations are not counted:
/// one for each probe value as often as effects are left, and some hundred for each effect.
/// @param start [n] @return [n] a point of lower cost, or the start; the start also if it was stopped
[[nodiscard]] Vector ProbedStart(const LeastSquares& fit, const Vector& start, const ProbedSearch& search);

}  // namespace sinew::solvers
