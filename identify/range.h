// A range that predicted but unmeasured values should stay in, entered in a fit as a residual or as a
// constraint.
#pragma once

#include "base/linear_algebra.h"

namespace sinew {

struct Range {
  double lower = 0;     ///< [unit of the values]
  double upper = 1;     ///< > lower
  bool strict = false;  ///< true: an inequality constraint; false: a residual that is zero within the range
};

/// Root of the sum of squared distances of the values from the range. Its square is continuously
/// differentiable.
/// @param values [N] @param slopes if not null, d result / d value [N]; zero if all values are within
double DistanceFrom(const Range& range, const Eigen::Ref<const Vector>& values, Vector* slopes);

/// A smooth upper bound on the largest signed distance of the values from the range (at most 0 if all are
/// within): at most a hundredth of the range's width above it, never below. It is the logarithm of a sum of
/// exponentials; the largest distance itself is not differentiable.
/// @param slopes if not null, d result / d value [N]
double FarthestFrom(const Range& range, const Eigen::Ref<const Vector>& values, Vector* slopes);

}  // namespace sinew
