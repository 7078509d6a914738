// Solver `starts`: local searches by `lm` from the given start and from those that the problem states.
#pragma once

#include "identify/solvers/solver.h"

namespace sinew::solvers {

/// For problems whose other minima are known to lie along few parameters (Parameter::other_starts), where a
/// search from anywhere is expensive and seldom better: a search from the given start, and one from each
/// other start of each free parameter with all others as given. Starts outside of the fit's bounds are left
/// out. A problem that states none is searched by `lm` alone.
///
/// Shares of the budget are equal. Of ends whose costs differ by less than 1e-8 of themselves the one of the
/// given start is the answer. The stages are the ends, lowest cost first. What is evaluated does not depend
/// on the number of threads.
class StatedStarts : public Solver {
 public:
  explicit StatedStarts(const SolverOptions& options) : options_(options) {}

  [[nodiscard]] bool ToleratesFailedStart() const override { return true; }

 private:
  Search DoSolve(Evaluator& evaluator, const Vector& start) const override;

  SolverOptions options_;
};

}  // namespace sinew::solvers
