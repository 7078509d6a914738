// A local fit that leaves minima which only drifts of a simulation make.
#pragma once

#include <functional>

#include "identify/solvers/local_fit.h"

namespace sinew::solvers {

/// Ordinary and generalised least squares (ResidualWhitening) alternately, as long as the ordinary cost
/// falls by more than a hundredth. Where nothing feeds the position back, or where dry friction decides when
/// a joint stops, small errors of the force add up to a drift, and the plain cost has minima that trade one
/// drift for another; the whitened cost counts what changes from sample to sample.
/// @param fit its transform is lost @param x [n, in 0..1] @param tolerance of the plain fits
/// @return of the plain cost: at most that at x; x itself where nothing can be predicted
[[nodiscard]] LocalFit::Outcome AlternatingFit(LeastSquares& fit, const Vector& x,
                                               LocalFit::Tolerance tolerance,
                                               const std::function<bool()>& stop);

}  // namespace sinew::solvers
