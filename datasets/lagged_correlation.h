// Correlation of two series at many lags.
#pragma once

#include <vector>

namespace sinew {

/// Pearson's correlation of b with a delayed by each lag: of the pairs a[i - lag], b[i]. Pairs with NaN are
/// left out. O(N longest); takes no copies of the series.
/// @param a, b [N]
/// @param longest >= 0 [samples]
/// @return [2 longest + 1], of the lags -longest to longest; NaN where one of them does not vary
[[nodiscard]] std::vector<double> LaggedCorrelations(const std::vector<double>& a,
                                                     const std::vector<double>& b, int longest);

}  // namespace sinew
