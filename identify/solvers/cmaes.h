// Solver `cmaes`: covariance matrix adaptation.
#pragma once

#include "identify/solvers/solver.h"

namespace sinew::solvers {

/// CMA-ES, (mu/mu_w, lambda) with rank-one and rank-mu update, over the box [0, 1]^n.
///
/// Population 4 + 3 ln n, first standard deviation 0.3. Sample points outside the box are reflected into it.
/// Points without prediction rank last. Ends when the best costs of the last 10 + 30 n / lambda generations
/// agree within the tolerance, or when the distribution has shrunk to rounding or become singular. Same seed,
/// same answer: unlike the CMA-ES of Simbody, which schedules its eigendecompositions by the clock, needs at
/// least two variables, can end the process, and reports no stop reason.
/// Source: Hansen, Ostermeier (2001), Evolutionary Computation 9(2):159-195; Hansen (2016), The CMA Evolution
/// Strategy: A Tutorial, arXiv:1604.00772, figure 6 and table 1 (without negative weights).
class CmaEs : public Solver {
 public:
  CmaEs(std::uint64_t seed, double cost_tolerance) : seed_(seed), cost_tolerance_(cost_tolerance) {}

  [[nodiscard]] bool ToleratesFailedStart() const override { return true; }

 private:
  Search DoSolve(Evaluator& evaluator, const Vector& start) const override;

  std::uint64_t seed_;
  double cost_tolerance_;
};

}  // namespace sinew::solvers
