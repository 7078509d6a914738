// Local searches from many starts, on several threads, with one common record.
#pragma once

#include <vector>

#include "identify/solvers/solver.h"

namespace sinew::solvers {

/// A start and its limit of evaluations.
struct PolishingStart {
  Vector x;
  long evaluations = 0;  ///< at most
};

/// The points with equal shares of a budget. @param budget of all together; kUnlimitedEvaluations less those
/// that were spent is unlimited too
[[nodiscard]] std::vector<PolishingStart> EqualShares(const std::vector<Vector>& points, long budget);

struct Polished {
  Stage stage;
  int iterations = 0;
};

/// Searches from every start with a solver, each with its own evaluator, and appends the evaluations to the
/// parent's record in the order of the starts. Starts after one that reached the parent's target are dropped:
/// what is recorded, apart from times, does not depend on the number of threads.
/// Those that the parent has from the run that it resumes (Evaluator::Options::finished) are not done again.
/// @param name of the solver, for the stages
/// @return the starts whose evaluations were appended, in order
std::vector<Polished> PolishAll(Evaluator& parent, const Solver& solver, const std::string& name,
                                const std::vector<PolishingStart>& starts, int threads);

}  // namespace sinew::solvers
