#include "base/linear_basis.h"

#include <algorithm>

namespace sinew {

Hats HatsAt(const std::vector<double>& knots, double x) {
  Hats hats;
  if (x <= knots.front()) return hats;
  if (x >= knots.back()) {
    hats.first = static_cast<int>(knots.size()) - 1;
    return hats;
  }
  const auto after = std::upper_bound(knots.begin(), knots.end(), x);
  const double width = *after - *(after - 1);
  hats.first = static_cast<int>(after - knots.begin()) - 1;
  hats.right = (x - *(after - 1)) / width;
  hats.left = 1 - hats.right;
  hats.left_slope = -1 / width;
  return hats;
}

}  // namespace sinew
