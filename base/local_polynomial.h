// Local polynomial regression: the value of a noisy record at one place, from the samples around it.
#pragma once

#include <vector>

namespace sinew {

/// Coefficients a [K] of the samples y [K] at the places x, such that a' y is the value at 0 of the
/// polynomial of the given degree that fits them best by weighted least squares; they sum to 1. For evenly
/// spaced samples of equal weight it is the smoothing of Savitzky and Golay (1964); in general local
/// polynomial regression (Fan, Gijbels 1996). Its noise, for white noise of variance 1 in y, has the variance
/// a' a.
/// @param x [K] @param weights [K, >= 0] @param degree [>= 0] @return empty: the samples of weight above 0
/// do not determine such a polynomial
[[nodiscard]] std::vector<double> LocalPolynomial(const std::vector<double>& x,
                                                  const std::vector<double>& weights, int degree);

/// What that polynomial leaves of the samples y [K]: the weighted sum of squared residuals. NaN where the
/// samples of weight above 0 do not determine it. @param y not read where the weight is 0
[[nodiscard]] double LocalPolynomialResidual(const std::vector<double>& x, const std::vector<double>& y,
                                             const std::vector<double>& weights, int degree);

}  // namespace sinew
