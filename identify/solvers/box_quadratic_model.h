// Steps of a Levenberg-Marquardt search over the box [0, 1]^n.
#pragma once

#include "identify/least_squares.h"

namespace sinew {

/// The quadratic that the residuals look like at one point: cost + gradient' d + d' normal d / 2.
struct BoxQuadraticModel {
  Matrix normal;    ///< J'J [n, n]
  Vector gradient;  ///< J'r [n]

  /// @param residuals, jacobian at the point. @return false if a derivative is not finite.
  bool Set(Eigen::Index variables, const Vector& residuals, const SparseJacobian& jacobian);

  /// The damped step from x that keeps to the box: variables that the step would carry over a bound go to the
  /// bound, and the others are solved for again with that known.
  /// @param held variable that stays as it is, or -1 @param damping of columns that are scaled to unit length
  /// [1, >= 0] @param gain by how much the quadratic falls along the step.
  /// Source: Levenberg (1944), Marquardt (1963).
  [[nodiscard]] Vector BoxStep(const Vector& x, int held, double damping, double& gain) const;
};

}  // namespace sinew
