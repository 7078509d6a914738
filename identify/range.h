// Where predicted values should stay, though nobody measured them: how far they leave it, as a residual or as
// a constraint.
#pragma once

#include "base/linear_algebra.h"

namespace sinew {

struct Range {
  double lower = 0;     ///< [unit of the values]
  double upper = 1;     ///< > lower
  bool strict = false;  ///< a constraint of the fit; else a residual, zero within the range
};

/// Root of the sum of squares by which the values lie outside. Its square has a continuous slope.
/// @param values [N] @param slopes if not null, d result / d value [N]; 0 if none lies outside
double DistanceFrom(const Range& range, const Eigen::Ref<const Vector>& values, Vector* slopes);

/// A smooth bound of the farthest that any value lies outside: at most a hundredth of the range's width above
/// it, never below. At most 0: all are within. (Logarithm of a sum of exponentials; the farthest itself has
/// kinks.)
/// @param slopes if not null, d result / d value [N]
double FarthestFrom(const Range& range, const Eigen::Ref<const Vector>& values, Vector* slopes);

}  // namespace sinew
