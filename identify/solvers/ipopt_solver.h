// Solver `ipopt`: an interior-point method that handles constraints.
#pragma once

#include "identify/solvers/solver.h"

namespace sinew::solvers {

/// Ipopt's primal-dual interior-point method with a filter line search over the box [0, 1]^n and the
/// constraints of the problem (Waechter, Biegler 2006, Math. Program. 106:25-57).
///
/// Every new iterate is one evaluation, with derivatives. A point without prediction shortens the step. Ends
/// when the optimality error (gradient of the Lagrangian, constraints, complementarity) is below 1e-10 of
/// Ipopt's scaling. Solves in one process run one after another: its linear solver MUMPS keeps global state.
class IpoptSolver : public Solver {
 public:
  enum class Hessian {
    kGaussNewton,   ///< J'J: exact where residuals vanish, the usual choice for least squares
    kLimitedMemory  ///< L-BFGS: for large residuals that are far from linear
  };

  explicit IpoptSolver(Hessian hessian) : hessian_(hessian) {}

  [[nodiscard]] bool ToleratesInfeasibleStart() const override { return true; }

 private:
  Search DoSolve(Evaluator& evaluator, const Vector& start) const override;

  Hessian hessian_;
};

}  // namespace sinew::solvers
