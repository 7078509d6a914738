// A piecewise linear function whose values at the knots, and whose argument, may have derivatives.
#pragma once

#include <type_traits>
#include <vector>

#include "base/dual.h"
#include "base/linear_basis.h"

namespace sinew {

/// sum of weights times linear basis functions at x. @param knots [K >= 1, increasing] @param weights [K]
/// @tparam T double or Dual @tparam X double or T
template <class T, class X>
[[nodiscard]] T LinearCurveAt(const std::vector<double>& knots, const T* weights, const X& x) {
  const LinearBasis basis = LinearBasisAt(knots, Value(x));
  const T& left = weights[basis.first];
  T sum = basis.left * left;
  if (basis.left_slope == 0) return sum;
  const T& right = weights[basis.first + 1];
  sum += basis.right * right;
  if constexpr (!std::is_same_v<X, double>)
    sum += (basis.left_slope * (Value(left) - Value(right))) * Tangent(x);
  return sum;
}

}  // namespace sinew
