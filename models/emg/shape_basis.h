// A smooth curve on a circle: the shape of a muscle's EMG over one cycle of a movement, as an envelope's
// filter shows it.
//
//   S(phase) = sum_j c_j b(phase - j / K),   b(phase) = sum_n B_n H(n / T) exp(2 pi i n phase)
//
// B_n are the Fourier coefficients of the periodic cubic B-spline with K knots, sinc(n / K)^4 / K, and H(f) =
// 1 / (1 + (f / cut-off)^4) is the low-pass of the envelope, run forward and backward: in a fast cycle (small
// period T) it rounds the bursts more than in a slow one. Without a filter b is the spline itself.
// Sources: de Boor, A Practical Guide to Splines (1978), ch. IX; envelope.h.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "base/error.h"
#include "base/linear_algebra.h"

namespace sinew {

constexpr int kMinKnots = 4;

class ShapeBasis {
 public:
  /// @param knots K >= 4 @param harmonics cut-off times period: the harmonic that the envelope's filter
  /// halves; 0: no filter @param jitter standard deviation of the timing of cycles whose mean this is
  /// [cycle]; 0: one cycle
  explicit ShapeBasis(int knots, double harmonics = 0, double jitter = 0);

  [[nodiscard]] int knots() const { return knots_; }
  /// @param phase [cycles, finite; its whole part does not matter] @param values [K] @param slopes [K,
  /// 1/cycle]; may be null
  void At(double phase, double* values, double* slopes) const;
  /// The curve with these control points [K].
  [[nodiscard]] double Value(double phase, const double* control) const;
  [[nodiscard]] double Slope(double phase, const double* control) const;

 private:
  struct One {
    double value = 0;
    double slope = 0;
  };
  [[nodiscard]] One OneAt(double phase) const;  // b

  int knots_;
  std::vector<One> table_;  // of b over one cycle; empty without a filter
};

/// Control points by least squares. Where there are no samples, the curve is continued smoothly.
/// @param phase [N, cycles] @param values [N]
/// @return [K]. Errors: sizes, fewer samples than control points, a number that is not finite.
Result<Vector> FitShape(const std::vector<double>& phase, const std::vector<double>& values,
                        const ShapeBasis& basis);

}  // namespace sinew
