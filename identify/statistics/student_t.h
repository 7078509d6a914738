// The t and F distributions, for intervals with an estimated noise level.
#pragma once

namespace sinew::statistics {

/// P(T <= t) of Student's t with `degrees_of_freedom` > 0; infinity is the standard normal distribution.
/// By the incomplete beta function: Abramowitz, Stegun 1964, 26.7.1 and 26.5.8.
[[nodiscard]] double StudentTCdf(double t, double degrees_of_freedom);

/// The t with P(T <= t) = probability; its square is the quantile of F(1, degrees_of_freedom), of chi-squared
/// with one degree for infinity. NaN unless 0 < probability < 1 and degrees_of_freedom > 0.
[[nodiscard]] double StudentTQuantile(double probability, double degrees_of_freedom);

/// P(F > f) of the F distribution with `first` and `second` > 0 degrees of freedom; 1 for f <= 0. Relatively
/// accurate in the tail (Abramowitz, Stegun 1964, 26.6.2).
[[nodiscard]] double FUpperTail(double f, double first, double second);

}  // namespace sinew::statistics
