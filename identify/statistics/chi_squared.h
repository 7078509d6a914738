// Tails of the chi-squared and normal distributions, accurate where one minus the distribution function is
// zero in double precision.
#pragma once

namespace sinew::statistics {

/// P(X >= x) for chi-squared with `degrees_of_freedom` > 0; 1 for x <= 0. By the regularised incomplete gamma
/// function: series below the mean, continued fraction above (Abramowitz, Stegun 1964, 6.5.29 and 6.5.31;
/// Press et al. 2007, section 6.2). Relative error about 1e-13 for up to 100 degrees, growing with degrees
/// (the difference of large log-gamma values): 1e-10 at 1e5.
[[nodiscard]] double ChiSquaredUpperTail(double x, double degrees_of_freedom);

/// Its natural logarithm, also where the tail itself is below the smallest double.
[[nodiscard]] double LogChiSquaredUpperTail(double x, double degrees_of_freedom);

/// The z >= 0 with P(|Z| >= z) = p for a standard normal Z: 1.96 for 0.05. Exact to rounding down to the
/// smallest p; infinite for p <= 0, 0 for p >= 1.
[[nodiscard]] double TwoSidedThreshold(double p);

}  // namespace sinew::statistics
