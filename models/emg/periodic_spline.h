// A smooth curve on a circle: the shape of a muscle's EMG over one cycle of a movement.
//
//   S(phase) = sum_j c_j B(K phase - j),  j and phase modulo K and 1, B the cubic B-spline on [-2, 2]
//
// Two continuous derivatives everywhere, the cycle's end included. Between the smallest and the largest of
// its control points. Source: de Boor, A Practical Guide to Splines (1978), ch. IX.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "base/error.h"
#include "base/linear_algebra.h"

namespace sinew {

constexpr int kSplineSupport = 4;

/// The basis functions that are not zero at one phase.
struct PeriodicBasis {
  std::array<int, kSplineSupport> knot{};
  std::array<double, kSplineSupport> value{};
  std::array<double, kSplineSupport> slope{};  ///< d/dphase [1/cycle]

  [[nodiscard]] double At(const double* control) const {
    double sum = 0;
    for (std::size_t i = 0; i < kSplineSupport; ++i) sum += value[i] * control[knot[i]];
    return sum;
  }
  [[nodiscard]] double SlopeAt(const double* control) const {
    double sum = 0;
    for (std::size_t i = 0; i < kSplineSupport; ++i) sum += slope[i] * control[knot[i]];
    return sum;
  }
};

/// @param phase [cycles, finite; its whole part does not matter] @param knots K >= 4
[[nodiscard]] PeriodicBasis PeriodicBasisAt(double phase, int knots);

/// Control points by least squares. Where no sample speaks, the curve runs smoothly on.
/// @param phase [N, cycles] @param values [N] @param knots K >= 4
/// @return [K]. Errors: sizes, fewer samples than control points, a number that is not finite.
Result<Vector> FitPeriodicSpline(const std::vector<double>& phase, const std::vector<double>& values,
                                 int knots);

}  // namespace sinew
