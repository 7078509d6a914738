// Solver `basin-hopping` (alias `hop`): local searches from points around the best one so far.
#pragma once

#include "identify/solvers/solver.h"

namespace sinew {

/// Monotonic basin hopping: the best point is displaced at random in all variables and searched from by `lm`;
/// a lower cost becomes the new best point.
///
/// For costs with many local minima that lie in a funnel, as those of muscles that can stand in for each
/// other: there a start next to a good answer is worth more than one anywhere in the box (`multistart`).
/// Four hops at a time, whatever the number of threads. Ends when SolverOptions::starts hops in a row gained
/// less than a thousandth of the cost; the best point is then searched from once more without a limit. If the
/// start cannot be predicted, as many others are tried.
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

}  // namespace sinew
