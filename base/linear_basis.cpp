#include "base/linear_basis.h"

#include <algorithm>

namespace sinew {

LinearBasis LinearBasisAt(const std::vector<double>& knots, double x) {
  LinearBasis basis;
  if (x <= knots.front()) return basis;
  if (x >= knots.back()) {
    basis.first = static_cast<int>(knots.size()) - 1;
    return basis;
  }
  const auto after = std::upper_bound(knots.begin(), knots.end(), x);
  const double width = *after - *(after - 1);
  basis.first = static_cast<int>(after - knots.begin()) - 1;
  basis.right = (x - *(after - 1)) / width;
  basis.left = 1 - basis.right;
  basis.left_slope = -1 / width;
  return basis;
}

}  // namespace sinew
