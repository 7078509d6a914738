// A small bounded Levenberg-Marquardt search, for refits that start next to their answer: profiles need
// hundreds of them, so they cost an evaluation or three each and allocate little.
#pragma once

#include <string>

#include "base/linear_algebra.h"
#include "identify/least_squares.h"
#include "identify/solvers/box_quadratic_model.h"

namespace sinew {

/// Levenberg 1944, Marquardt 1963, with variables on a bound held while the gradient pushes outward, and
/// steps that keep to the box (BoxQuadraticModel). Problem::constraints() enter as quadratic penalties. One
/// per thread.
class LocalFit {
 public:
  struct Outcome {
    Vector x;                ///< [n] best point
    double cost = 0;         ///< there, penalties included
    bool converged = false;  ///< the next step would gain less than the tolerance
    std::string failure;     ///< why there is no prediction at the start; empty otherwise
  };

  /// @param penalty weight of the constraints; 0: fitted to the first point. Costs of two LocalFits can be
  /// compared if their penalties are the same.
  explicit LocalFit(const LeastSquares& least_squares, double penalty = 0);

  /// The search ends when the next step is predicted to gain less than absolute + relative * cost, or than
  /// the grain of the cost.
  struct Tolerance {
    double absolute = 0;
    double relative = 0;
  };

  /// @param start [n, in 0..1] @param held variable that stays as it is, or -1 @param max_evaluations of
  /// residuals, with or without Jacobian.
  Outcome Minimize(const Vector& start, int held, Tolerance tolerance, long max_evaluations);

  [[nodiscard]] const LeastSquares& least_squares() const { return least_squares_; }
  [[nodiscard]] long evaluations() const { return evaluations_; }
  [[nodiscard]] double penalty() const { return penalty_; }

 private:
  Status Cost(const Vector& x, double& cost);
  Status CostAndDerivatives(const Vector& x, double& cost);
  void AddPenalties(const Vector& x, double& cost, bool derivatives);

  const LeastSquares& least_squares_;
  LeastSquares::Workspace workspace_;
  SparseJacobian jacobian_;
  Vector residuals_;
  BoxQuadraticModel equations_;
  Vector constraint_;
  Matrix constraint_jacobian_;
  double penalty_;
  long evaluations_ = 0;
};

}  // namespace sinew
