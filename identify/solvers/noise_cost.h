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

}  // namespace sinew::solvers
