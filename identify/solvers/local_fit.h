// A bounded Levenberg-Marquardt search for refits that start close to their solution: profile likelihoods
// need hundreds of them, so that each takes a few evaluations and allocates little.
#pragma once

#include <optional>
#include <string>

#include "base/linear_algebra.h"
#include "identify/least_squares.h"
#include "identify/solvers/box_quadratic_model.h"

namespace sinew::solvers {

/// Levenberg 1944, Marquardt 1963, in the box (BoxQuadraticModel): variables on a bound are held there while
/// the cost decreases outward. Along curved valleys, where the straight step does not lower the cost, the
/// step follows the curve (Transtrum and Sethna 2012, geodesic acceleration). Problem::constraints() are
/// included as quadratic penalties. One per thread.
class LocalFit {
 public:
  struct Outcome {
    Vector x;                ///< [n] best point
    double cost = 0;         ///< there, penalties included
    bool converged = false;  ///< the predicted decrease of the next step is below the tolerance
    std::string failure;     ///< why there is no prediction at the start; empty otherwise
  };

  /// @param penalty weight of the constraints; 0: scaled to the Jacobian at the first point. Costs of two
  /// LocalFits are comparable only if their penalties are equal.
  explicit LocalFit(const LeastSquares& least_squares, double penalty = 0);

  /// The search ends when the predicted decrease of the next step is below absolute + relative * cost, or
  /// below the noise level of the cost.
  struct Tolerance {
    double absolute = 0;
    double relative = 0;
  };

  /// @param start [n, in 0..1] @param held variable that is fixed, or -1 @param max_evaluations of residuals,
  /// with or without Jacobian
  ///
  /// The one place through which the refits of a diagnosis and of profiles go: what the record of the setup
  /// (FitSetup::record) holds is taken from there, and counts as many evaluations as it took.
  Outcome Minimize(const Vector& start, int held, Tolerance tolerance, long max_evaluations);

  /// Cost at x [n, in 0..1], penalties included, and its Gauss-Newton model there: model(). One evaluation.
  /// Errors: no prediction at x, or a derivative that is not finite.
  Result<double> ModelAt(const Vector& x);
  /// Of the point of the last ModelAt; the next call that evaluates overwrites it.
  [[nodiscard]] const BoxQuadraticModel& model() const { return equations_; }

  [[nodiscard]] const LeastSquares& least_squares() const { return least_squares_; }
  [[nodiscard]] long evaluations() const { return evaluations_; }
  [[nodiscard]] double penalty() const { return penalty_; }

 private:
  Outcome Search(const Vector& start, int held, Tolerance tolerance, long max_evaluations);
  Status Cost(const Vector& x, double& cost);
  Status CostAndDerivatives(const Vector& x, double& cost);
  // The step and what the curvature of the residuals adds to it; nothing where that is not small. One
  // evaluation.
  std::optional<Vector> CurvedStep(const Vector& x, const Vector& step, double damping);
  void AddPenalties(const Vector& x, double& cost, bool derivatives);

  const LeastSquares& least_squares_;
  LeastSquares::Workspace workspace_;
  SparseJacobian jacobian_;
  Vector residuals_;
  Vector at_x_;  // residuals where jacobian_ is
  BoxQuadraticModel equations_;
  Vector constraint_;
  Matrix constraint_jacobian_;
  double penalty_;
  long evaluations_ = 0;
};

}  // namespace sinew::solvers
