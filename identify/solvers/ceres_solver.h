// Solver `ceres`: bounded Levenberg-Marquardt on the residual blocks.
#pragma once

#include "identify/solvers/solver.h"

namespace sinew::solvers {

/// Ceres Solver's trust-region method over the box [0, 1]^n (Levenberg 1944, Marquardt 1963; Agarwal, Mierle
/// et al., ceres-solver.org).
///
/// Every new iterate is one evaluation, with derivatives. Variables that belong to one trial
/// (Parameter::trial) form a parameter block of their own, so that many trials with nuisance values give a
/// sparse Jacobian; the normal equations are then factorised sparsely (Cholesky), else the Jacobian is by
/// dense QR. A point without prediction is a rejected step. Stops on the relative change of the cost, on the
/// projected gradient relative to the first cost, and on the length of the step. Departure: variables that
/// the cost pushes against a bound are held there while the others are searched (an active set); Ceres alone
/// stops too early at active bounds.
class CeresSolver : public Solver {
 public:
  explicit CeresSolver(double cost_tolerance) : cost_tolerance_(cost_tolerance) {}

 private:
  Search DoSolve(Evaluator& evaluator, const Vector& start) const override;

  double cost_tolerance_;
};

}  // namespace sinew::solvers
