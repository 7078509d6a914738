// Derivatives of a problem against differences of its predictions.
#pragma once

#include <set>

#include "base/random.h"
#include "identify/problem.h"

namespace sinew {

struct JacobianCheck {
  int columns = 0;      ///< of all blocks
  int compared = 0;     ///< those that are smooth at this point
  double worst = 0;     ///< largest difference of a compared column, relative to its size
  std::set<int> never;  ///< parameters of which no column was compared
};

/// Compares every column of every block at `parameters`, which must lie inside the bounds by 0.1 % of the
/// range.
///
/// A column's size is the norm of the derivative over the parameter's range (for a logarithmic scale: over
/// its value), or 1e-3 of the block's values if that is larger, below which differences drown in rounding. A
/// sample is left out where one-sided or third differences disagree: the problem has a kink there. A column
/// of which more than a fifth of the samples are left out is not compared.
JacobianCheck CheckJacobian(const Problem& problem, const Vector& parameters);

/// Expects that nearly all columns compare, and agree, at ten random points.
/// @param least_compared share of the columns: fewer where one instant's kink is felt by all later ones
void ExpectJacobianAgrees(const Problem& problem, Random& random, double least_compared = 0.9);

/// A random point at least `margin` of the range away from every bound; logarithmic where the scale is.
Vector RandomInside(const Problem& problem, double margin, Random& random);

}  // namespace sinew
