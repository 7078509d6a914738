// Natural cubic spline through samples, with exact first and second derivatives.
#pragma once

#include <cstddef>
#include <vector>

#include "base/error.h"

namespace sinew {

/// What any spline needs. Errors: sizes differ, fewer than `least` samples, time not increasing, a value that
/// is not finite.
[[nodiscard]] Status CheckSplineSamples(const std::vector<double>& time, const std::vector<double>& values,
                                        std::size_t least);

/// Piecewise cubic that passes through every sample, has continuous second derivatives, and zero second
/// derivative at both ends. Source: de Boor, A Practical Guide to Splines (1978), ch. IV.
class NaturalCubicSpline {
 public:
  struct Value {
    double value = 0;
    double first = 0;   ///< d/dt
    double second = 0;  ///< d2/dt2
  };

  /// @param time    [N, s, strictly increasing, N >= 2]; @param values [N]. Errors: those of
  /// CheckSplineSamples.
  static Result<NaturalCubicSpline> Fit(std::vector<double> time, std::vector<double> values);

  /// Value and derivatives at t; outside the samples the end cubic continues as a straight line (its second
  /// derivative is zero there).
  [[nodiscard]] Value At(double t) const;

  [[nodiscard]] double first_time() const { return time_.front(); }
  [[nodiscard]] double last_time() const { return time_.back(); }

 private:
  NaturalCubicSpline() = default;
  std::vector<double> time_;
  std::vector<double> values_;
  std::vector<double> second_;  // second derivative at each sample
};

}  // namespace sinew
