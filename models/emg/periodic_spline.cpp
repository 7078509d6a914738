#include "models/emg/periodic_spline.h"

#include <cmath>

#include "base/decompositions.h"

namespace sinew {
namespace {

// Of second differences, beside squares of the data: decides only where these are silent.
constexpr double kSmoothing = 1e-12;

}  // namespace

PeriodicBasis PeriodicBasisAt(double phase, int knots) {
  const double place = (phase - std::floor(phase)) * knots;
  const double whole = std::floor(place);
  const double u = place - whole;
  const double v = 1 - u;
  const int first = static_cast<int>(whole) + knots - 1;
  PeriodicBasis basis;
  for (int i = 0; i < kSplineSupport; ++i) basis.knot[static_cast<std::size_t>(i)] = (first + i) % knots;
  basis.value = {v * v * v / 6, (3 * u * u * u - 6 * u * u + 4) / 6, (3 * v * v * v - 6 * v * v + 4) / 6,
                 u * u * u / 6};
  basis.slope = {-knots * v * v / 2, knots * (3 * u * u - 4 * u) / 2, -knots * (3 * v * v - 4 * v) / 2,
                 knots * u * u / 2};
  return basis;
}

Result<Vector> FitPeriodicSpline(const std::vector<double>& phase, const std::vector<double>& values,
                                 int knots) {
  if (phase.size() != values.size())
    return Fail("{} phases and {} values, expected as many", phase.size(), values.size());
  if (knots < kSplineSupport) return Fail("{} control points, expected at least {}", knots, kSplineSupport);
  if (phase.size() < static_cast<std::size_t>(knots))
    return Fail("{} samples are too few for {} control points", phase.size(), knots);
  Matrix normal = Matrix::Zero(knots, knots);
  Vector right = Vector::Zero(knots);
  for (std::size_t i = 0; i < phase.size(); ++i) {
    if (!std::isfinite(phase[i]) || !std::isfinite(values[i])) return Fail("sample {} is no number", i);
    const PeriodicBasis basis = PeriodicBasisAt(phase[i], knots);
    for (std::size_t a = 0; a < kSplineSupport; ++a) {
      right[basis.knot[a]] += basis.value[a] * values[i];
      for (std::size_t b = 0; b < kSplineSupport; ++b)
        normal(basis.knot[a], basis.knot[b]) += basis.value[a] * basis.value[b];
    }
  }
  const double weight = kSmoothing * normal.diagonal().mean();
  for (int j = 0; j < knots; ++j) {
    const std::array<int, 3> at{(j + knots - 1) % knots, j, (j + 1) % knots};
    constexpr std::array<double, 3> kDifference{1, -2, 1};
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = 0; b < 3; ++b) normal(at[a], at[b]) += weight * kDifference[a] * kDifference[b];
    }
  }
  const Vector control = Eigen::LDLT<Matrix>(normal).solve(right);
  if (!control.allFinite()) return Fail("the samples do not determine a curve");
  return control;
}

}  // namespace sinew
