// Steps of the Levenberg-Marquardt method in the box [0, 1]^n.
#pragma once

#include <optional>

#include "identify/least_squares.h"

namespace sinew::solvers {

/// The Gauss-Newton model of the cost at one point: cost + gradient' d + d' normal d / 2.
struct BoxQuadraticModel {
  Matrix normal;    ///< J'J [n, n]
  Vector gradient;  ///< J'r [n]

  /// @param residuals, jacobian at the point. @return false if a derivative is not finite
  bool Set(Eigen::Index variables, const Vector& residuals, const SparseJacobian& jacobian);

  /// The damped step from x within the box: variables that the step would move beyond a bound are set to the
  /// bound, and the step of the others is solved for again.
  /// @param held variable that is fixed, or -1 @param damping of columns that are scaled to unit length [1,
  /// >= 0] @param gain decrease of the model along the step; may be negative where a variable would leave its
  /// bound again
  /// Source: Levenberg (1944), Marquardt (1963).
  [[nodiscard]] Vector ProjectedStep(const Vector& x, int held, double damping, double& gain) const;

  /// The same step, but where the model would fall if a variable left its bound again the minimum of the
  /// damped model in the box (BoxMinimum), so that gain >= 0.
  [[nodiscard]] Vector BoxStep(const Vector& x, int held, double damping, double& gain) const;

  /// Half of the acceleration along the curve of damped steps, to be added to `step`: what the second
  /// derivatives of the residuals along the step ask for. The variables that the step leaves within the box
  /// take part.
  /// @param pull J'k [n], k the second directional derivative of the residuals along the step
  /// @return nothing if it is not small beside the step, so that the expansion does not hold, or if the step
  /// ends on bounds alone
  /// Source: Transtrum and Sethna (2012), geodesic acceleration.
  [[nodiscard]] std::optional<Vector> Acceleration(const Vector& x, const Vector& step, double damping,
                                                   const Vector& pull) const;
};

}  // namespace sinew::solvers
