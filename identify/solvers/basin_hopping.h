// Solver `basin-hopping` (alias `hop`): local searches from points around the best one so far.
#pragma once

#include "identify/solvers/solver.h"

namespace sinew::solvers {

/// Monotonic basin hopping: the best point is displaced at random in all variables and a local search by `lm`
/// starts there; a lower cost becomes the new best point.
///
/// For costs with many local minima arranged in a funnel, as those of redundant muscles: there a start near a
/// good solution is more likely to improve it than one anywhere in the box (`multistart`). Four displacements
/// are searched at a time, whatever the number of threads. Ends when SolverOptions::starts successive ones
/// reduced the cost by less than a thousandth; the best point is then the start of one local search without a
/// limit. If the start cannot be predicted, up to as many other starts are tried.
/// Source: Wales, Doye (1997), J. Phys. Chem. A 101:5111-5116; Leary (2000), J. Global Optimization
/// 18:367-383.
class BasinHopping : public Solver {
 public:
  explicit BasinHopping(const SolverOptions& options) : options_(options) {}

  [[nodiscard]] bool ToleratesFailedStart() const override { return true; }

 private:
  Search DoSolve(Evaluator& evaluator, const Vector& start) const override;

  SolverOptions options_;
};

}  // namespace sinew::solvers
