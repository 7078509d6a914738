// Whether a fit leaves more than noise, where the data's weights are one over the noise.
#pragma once

#include <cmath>

#include "identify/least_squares.h"

namespace sinew::solvers {

/// The cost of a right model and prior, at most: twice the minimum is chi-squared distributed with nearly as
/// many degrees of freedom as there are data rows (nuisance values bring a prior each); three standard
/// deviations above its mean.
[[nodiscard]] inline double LargestNoiseCost(const LeastSquares& fit) {
  const double rows = fit.data_rows();
  return 0.5 * rows + 3 * std::sqrt(0.5 * rows);
}

/// Up to this cost a minimum is near enough to that for two searches that agree to be believed: a wrong
/// minimum of a fit with curves costs several times as much, while a model or a prior that is a little wrong
/// costs no more than this.
[[nodiscard]] inline double NearNoiseCost(const LeastSquares& fit) {
  constexpr double kNear = 1.5;
  return kNear * LargestNoiseCost(fit);
}

}  // namespace sinew::solvers
