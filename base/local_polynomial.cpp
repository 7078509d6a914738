#include "base/local_polynomial.h"

#include <algorithm>
#include <cmath>

#include "base/linear_algebra.h"

namespace sinew {

std::vector<double> LocalPolynomial(const std::vector<double>& x, const std::vector<double>& weights,
                                    int degree) {
  constexpr double kDependent = 1e-9;  // share of a power's norm that lower powers leave
  const auto count = static_cast<Eigen::Index>(x.size());
  double longest = 0;
  for (const double place : x) longest = std::max(longest, std::abs(place));
  const double scale = longest > 0 ? longest : 1;

  // Powers times the roots of the weights, made orthonormal one after the other; beside them their values
  // at 0.
  Vector root(count);
  for (Eigen::Index k = 0; k < count; ++k) root[k] = std::sqrt(weights[static_cast<std::size_t>(k)]);
  Matrix basis(count, degree + 1);
  Vector at_zero = Vector::Zero(degree + 1);
  Vector power = root;
  for (int d = 0; d <= degree; ++d) {
    const double norm = power.norm();
    Vector rest = power;
    double value = d == 0 ? 1 : 0;
    for (int pass = 0; pass < 2; ++pass) {  // the second one against rounding
      for (int lower = 0; lower < d; ++lower) {
        const double along = basis.col(lower).dot(rest);
        rest -= along * basis.col(lower);
        value -= along * at_zero[lower];
      }
    }
    const double left = rest.norm();
    if (!(left > kDependent * norm)) return {};
    basis.col(d) = rest / left;
    at_zero[d] = value / left;
    for (Eigen::Index k = 0; k < count; ++k) power[k] *= x[static_cast<std::size_t>(k)] / scale;
  }
  const Vector sum = root.cwiseProduct(basis * at_zero);
  return {sum.data(), sum.data() + sum.size()};
}

}  // namespace sinew
