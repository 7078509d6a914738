// Interpolation of sampled signals at shifted times: natural cubic splines of many signals with the same
// sample times.
#pragma once

#include <vector>

#include "base/linear_algebra.h"

namespace sinew {

/// Delays signals that are sampled at fixed times. The curve is that of NaturalCubicSpline (base/spline.h),
/// but the parts that depend on the times alone are computed once and nothing is allocated afterwards. Beyond
/// the samples the curve continues as a straight line; a single sample as a constant.
class DelayLine {
 public:
  /// @param time [M, s, strictly increasing, M >= 1]
  explicit DelayLine(std::vector<double> time);

  /// Fits the spline. @param signal [M] @param second [M] out: its second derivative at the samples.
  void Fit(const Eigen::Ref<const Vector>& signal, Eigen::Ref<Vector> second) const;

  /// The fitted signal at time - delay.
  /// @param delay [s] @param value [M] out; not the signal itself @param slope [M, 1/s] out: d/dt there
  void Evaluate(double delay, const Eigen::Ref<const Vector>& signal, const Eigen::Ref<const Vector>& second,
                Eigen::Ref<Vector> value, Eigen::Ref<Vector> slope) const;

 private:
  std::vector<double> time_;
  std::vector<double> upper_;          // upper diagonal of the factorised tridiagonal system
  std::vector<double> inverse_pivot_;  // inverse pivots of its rows
};

}  // namespace sinew
