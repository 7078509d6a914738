// Local searches from many starts, on several threads, with one record.
#pragma once

#include <vector>

#include "identify/solvers/solver.h"

namespace sinew {

/// A start and what it may cost.
struct PolishingStart {
  Vector x;
  long evaluations = 0;  ///< at most
};

struct Polished {
  Stage stage;
  int iterations = 0;
};

/// Searches from every start with a solver, each with an evaluator of its own, and hands the evaluations to
/// the parent in the order of the starts. Starts after one that reached the parent's target are dropped: what
/// is recorded, apart from times, does not depend on the number of threads.
/// @param name of the solver, for the stages.
/// @return the starts that were taken over, in order.
std::vector<Polished> PolishAll(Evaluator& parent, const Solver& solver, const std::string& name,
                                const std::vector<PolishingStart>& starts, int threads);

}  // namespace sinew
