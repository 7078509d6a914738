// Solver `multistart`: local searches by `ceres` from many starts.
#pragma once

#include "identify/solvers/solver.h"

namespace sinew::solvers {

/// The given start and a Latin hypercube of others (McKay, Beckman, Conover 1979, Technometrics 21:239-245),
/// each the start of a Ceres search with its own share of the budget, on several threads.
///
/// Shares are equal; a budget too small for at least 20 evaluations each reduces the number of starts. What a
/// start that converges leaves of its share is not used by others. If starts are left out, or end at their
/// share, the stop reason is kStartsUnfinished; its test has the numbers. Evaluations are recorded in the
/// order of the starts, and those of starts after one that reached the target are dropped: the answer and the
/// trace, apart from times, do not depend on the number of threads. The stages are the waterfall: every
/// start, lowest cost first.
class MultiStart : public Solver {
 public:
  explicit MultiStart(const SolverOptions& options) : options_(options) {}

  [[nodiscard]] bool ToleratesFailedStart() const override { return true; }

 private:
  Search DoSolve(Evaluator& evaluator, const Vector& start) const override;

  SolverOptions options_;
};

/// Points of a Latin hypercube in [0, 1]^n: in every variable, each of `count` equal intervals holds one.
[[nodiscard]] std::vector<Vector> LatinHypercube(int count, int variables, std::uint64_t seed);

}  // namespace sinew::solvers
