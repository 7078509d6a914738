// Natural quintic spline through samples, whose second derivative is smooth.
#pragma once

#include <vector>

#include "base/error.h"

namespace sinew {

/// Piecewise polynomial of degree 5 that passes through every sample, has continuous derivatives up to the
/// fourth, and zero third and fourth derivatives at both ends: of all such curves the one with the least
/// integral of the squared third derivative. Its second derivative is that of the sampled curve to fourth
/// order in the distance of the samples; that of a cubic spline is too large by (2 pi f h)^2 / 12 at a
/// frequency f. Source: Woltring (1985), Hum. Mov. Sci. 4:229-245.
class NaturalQuinticSpline {
 public:
  struct Value {
    double value = 0;
    double first = 0;   ///< d/dt
    double second = 0;  ///< d2/dt2
  };

  /// @param time [N, s, strictly increasing, N >= 3]; @param values [N]. Errors: those of
  /// CheckSplineSamples.
  static Result<NaturalQuinticSpline> Fit(std::vector<double> time, std::vector<double> values);

  /// Value and derivatives at t; outside the samples it continues as a parabola.
  [[nodiscard]] Value At(double t) const;

  [[nodiscard]] double first_time() const { return time_.front(); }
  [[nodiscard]] double last_time() const { return time_.back(); }

 private:
  NaturalQuinticSpline() = default;
  std::vector<double> time_;
  std::vector<Value> samples_;
};

}  // namespace sinew
