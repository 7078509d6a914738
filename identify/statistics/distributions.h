// Tails and quantiles of the chi-squared, normal, t and F distributions, by Boost.Math (Maddock et al.),
// compiled in one place.
#pragma once

namespace sinew::statistics {

/// P(X >= x) for chi-squared with `degrees_of_freedom` > 0; 1 for x <= 0, NaN for NaN. Relatively accurate in
/// the tail.
[[nodiscard]] double ChiSquaredUpperTail(double x, double degrees_of_freedom);

/// The z >= 0 with P(|Z| >= z) = p for a standard normal Z: 1.96 for 0.05. Infinite for p <= 0, 0 for p >= 1.
[[nodiscard]] double TwoSidedThreshold(double p);

/// P(T <= t) of Student's t with `degrees_of_freedom` > 0; infinity is the standard normal distribution.
[[nodiscard]] double StudentTCdf(double t, double degrees_of_freedom);

/// The t with P(T <= t) = probability; its square is the quantile of F(1, degrees_of_freedom), of chi-squared
/// with one degree for infinity. NaN unless 0 < probability < 1 and degrees_of_freedom > 0.
[[nodiscard]] double StudentTQuantile(double probability, double degrees_of_freedom);

/// P(F > f) of the F distribution with `first` and `second` > 0 degrees of freedom; 1 for f <= 0. Relatively
/// accurate in the tail.
[[nodiscard]] double FUpperTail(double f, double first, double second);

}  // namespace sinew::statistics
