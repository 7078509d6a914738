// What a minimum is worth where hundreds of nuisance values have priors: they are integrated out.
#pragma once

#include "identify/least_squares.h"

namespace sinew::solvers {

/// Minus the logarithm of the marginal posterior density, up to a constant of the fit: the nuisance values
/// with priors are integrated out in Laplace's approximation, cost + ln det H / 2, where H [k x k] is the
/// Gauss-Newton matrix of these values. The cost alone is the density at its peak, and a peak may be so
/// narrow that next to nothing lies under it: a foot that sticks by a friction of ten, with every speed
/// adjusted to a thousandth, costs less than one that slides, and is improbable.
///
/// Infinite where there is no prediction. Without such values it is the cost.
/// Source: Tierney, Kadane (1986), J. Am. Stat. Assoc. 81:82-86; MacKay (1992), Neural Computation 4:415-447.
[[nodiscard]] double MarginalCost(const LeastSquares& fit, const Vector& x);

struct PredictedMinimum {
  double marginal = 0;  ///< the MarginalCost there; infinite where there is no prediction
  Vector parameters;    ///< [P], within their bounds
};

/// The minimum that the Gauss-Newton model at setup.rest predicts: exact where predictions are linear in what
/// is free. Nuisance values with priors may lie beyond their bounds at setup.rest, and the model leaves these
/// bounds out.
[[nodiscard]] PredictedMinimum PredictMinimum(const Problem& problem, const FitSetup& setup);

}  // namespace sinew::solvers
