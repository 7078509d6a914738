// Random starts for local searches: near a point, or anywhere in the box.
#pragma once

#include <vector>

#include "base/linear_algebra.h"
#include "base/random.h"
#include "identify/least_squares.h"

namespace sinew::solvers {

/// Draws starts in the box [0, 1]^n of a fit. Nuisance parameters, such as initial states, keep the value of
/// the point that they come from: they start at a measurement, which is better than chance, and there can be
/// hundreds.
class StartSampler {
 public:
  explicit StartSampler(const LeastSquares& fit);

  /// x with a Gaussian displacement of its moving variables, reflected at the bounds (many good points lie
  /// on one). Its standard deviation, as a share of the box, is drawn for each call: log-normal about 0.1,
  /// with a factor of e as one standard deviation. No single size serves: 0.05 leaves few funnels, and 0.15
  /// rarely improves a good point.
  [[nodiscard]] Vector Near(const Vector& x, Random& random) const;

  /// A Latin hypercube of `count` points of the moving variables; the others as in x.
  [[nodiscard]] std::vector<Vector> Anywhere(const Vector& x, int count, std::uint64_t seed) const;

 private:
  std::vector<int> moving_;
};

}  // namespace sinew::solvers
