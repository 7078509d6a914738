// A first-order low-pass of a sampled signal, exact for piecewise linear signals.
#pragma once

#include <vector>

#include "base/linear_algebra.h"

namespace sinew {

/// time_constant * dy/dt + y = x, for x linear between its samples and before the first one, because the
/// instrument was on before its record began. The recursion is exact for any sampling.
///
///   e_0 = -time_constant (x_1 - x_0) / h_1
///   e_i = E e_{i-1} - (time_constant / h) (1 - E) (x_i - x_{i-1}),   y = x + e,
///   E = exp(-h / time_constant)
///
/// At a time constant of 0 the signal is unchanged, and its derivative with respect to the time constant is
/// the limit -dx/dt, with dx/dt of the interval that ends at the sample (at the first: that begins there).
///
/// Source: exact discretisation of a first-order lag with first-order hold (Franklin, Powell, Workman,
/// Digital Control of Dynamic Systems, 1998, ch. 6.3).
class LowPass {
 public:
  /// @param time [M, s, increasing] @param time_constant [s, >= 0]. Allocates only if M grows.
  void Set(const std::vector<double>& time, double time_constant);

  /// Filters in place. @param signal [M]
  void Apply(Eigen::Ref<Vector> signal) const;
  /// Derivative of the filtered signal with respect to the time constant. @param signal [M] not filtered
  /// @param slope [M, unit of the signal / s]
  void Differentiate(const Eigen::Ref<const Vector>& signal, Eigen::Ref<Vector> slope) const;

 private:
  struct Step {
    double decay = 0;        // E
    double lag = 0;          // time_constant / h * (1 - E)
    double decay_slope = 0;  // d/d(time_constant)
    double lag_slope = 0;
  };
  double time_constant_ = 0;
  double first_step_ = 1;    // [s]
  std::vector<Step> steps_;  // [M] step to sample i from i - 1; the first is not used
};

}  // namespace sinew
