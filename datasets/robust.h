// Statistics that a minority of wrong values does not move.
#pragma once

#include <vector>

namespace sinew {

/// Value below which a share of the values lies, between order statistics. Long ones are not copied.
/// @param values not empty, no NaN
[[nodiscard]] double Quantile(const std::vector<double>& values, double share);

[[nodiscard]] double Median(const std::vector<double>& values);

/// Median absolute deviation from the median, times 1.4826: the standard deviation of normal values.
[[nodiscard]] double RobustDeviation(const std::vector<double>& values);

/// The values that are not NaN.
[[nodiscard]] std::vector<double> Finite(const std::vector<double>& values);

/// Pearson's correlation; NaN if one does not vary. Pairs with NaN are left out.
[[nodiscard]] double Correlation(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace sinew
