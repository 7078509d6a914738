#include "base/local_polynomial.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/linear_algebra.h"

namespace sinew {

namespace {

// Powers of x times the roots of the weights, made orthonormal one after the other.
struct Basis {
  Vector root;     // [K] of the weights
  Matrix columns;  // [K x degree + 1]
  Vector at_zero;  // [degree + 1] their values at 0
};

// False: the samples do not determine a polynomial of this degree.
bool MakeBasis(const std::vector<double>& x, const std::vector<double>& weights, int degree, Basis& basis) {
  constexpr double kDependent = 1e-9;  // share of a power's norm that lower powers leave
  const auto count = static_cast<Eigen::Index>(x.size());
  double longest = 0;
  for (const double place : x) longest = std::max(longest, std::abs(place));
  const double scale = longest > 0 ? longest : 1;

  basis.root.resize(count);
  for (Eigen::Index k = 0; k < count; ++k) basis.root[k] = std::sqrt(weights[static_cast<std::size_t>(k)]);
  basis.columns.resize(count, degree + 1);
  basis.at_zero = Vector::Zero(degree + 1);
  Vector power = basis.root;
  for (int d = 0; d <= degree; ++d) {
    const double norm = power.norm();
    Vector rest = power;
    double value = d == 0 ? 1 : 0;
    for (int pass = 0; pass < 2; ++pass) {  // the second one against rounding
      for (int lower = 0; lower < d; ++lower) {
        const double along = basis.columns.col(lower).dot(rest);
        rest -= along * basis.columns.col(lower);
        value -= along * basis.at_zero[lower];
      }
    }
    const double left = rest.norm();
    if (!(left > kDependent * norm)) return false;
    basis.columns.col(d) = rest / left;
    basis.at_zero[d] = value / left;
    for (Eigen::Index k = 0; k < count; ++k) power[k] *= x[static_cast<std::size_t>(k)] / scale;
  }
  return true;
}

}  // namespace

std::vector<double> LocalPolynomial(const std::vector<double>& x, const std::vector<double>& weights,
                                    int degree) {
  Basis basis;
  if (!MakeBasis(x, weights, degree, basis)) return {};
  const Vector sum = basis.root.cwiseProduct(basis.columns * basis.at_zero);
  return {sum.data(), sum.data() + sum.size()};
}

double LocalPolynomialResidual(const std::vector<double>& x, const std::vector<double>& y,
                               const std::vector<double>& weights, int degree) {
  Basis basis;
  if (!MakeBasis(x, weights, degree, basis)) return std::numeric_limits<double>::quiet_NaN();
  Vector rest = Vector::Zero(basis.root.size());
  for (Eigen::Index k = 0; k < rest.size(); ++k) {
    if (basis.root[k] > 0) rest[k] = basis.root[k] * y[static_cast<std::size_t>(k)];
  }
  for (Eigen::Index d = 0; d <= degree; ++d) rest -= basis.columns.col(d).dot(rest) * basis.columns.col(d);
  return rest.squaredNorm();
}

}  // namespace sinew
