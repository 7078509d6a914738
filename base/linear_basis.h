// Piecewise linear functions over knots.
#pragma once

#include <vector>

namespace sinew {

/// Values of the linear basis functions over `knots` at x: at most two are not zero.
struct LinearBasis {
  int first = 0;          ///< index of the left one
  double left = 1;        ///< value of the basis function `first`
  double right = 0;       ///< value of the basis function `first` + 1
  double left_slope = 0;  ///< d/dx of `left`; that of `right` is its negative
};

/// @param knots [K >= 1, increasing]. Beyond the outer knots the functions are constant.
[[nodiscard]] LinearBasis LinearBasisAt(const std::vector<double>& knots, double x);

}  // namespace sinew
