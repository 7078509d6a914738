// Solver `restarts`: basin hopping from independent starts until two of them end at the same minimum.
#pragma once

#include "identify/solvers/solver.h"

namespace sinew::solvers {

/// How many starts of a search ended at its best cost.
struct Agreement {
  int starts = 0;
  int agreeing = 0;      ///< ended within kSameMinimum of the best cost, the best one included
  double next_best = 0;  ///< lowest cost of the others, relative to the best: 1.12 is 12 % worse; 0: no other
};

/// Relative difference of two costs that are taken for the same minimum.
inline constexpr double kSameMinimum = 1e-3;

/// Relative difference of costs that is no reason to leave the end of the search from the given start: what
/// the data do not determine then keeps the value that it was given.
inline constexpr double kTie = 1e-8;

/// A search that ends when independent starts agree.
///
/// Local searches are by `lm`. Where nuisance parameters have priors, the search is that of ScheduledStarts.
///
/// 1. Local searches from the given start and from three others anywhere in the box. Where the best
///    cost is reached twice and white noise is left, this is the answer. Where structure is left, basin
///    hopping from the best point has to confirm it.
/// 2. Else basin hopping from the best of them, until a number of successive displacements have not reduced
///    the cost; then again from four new starts, and so on, until two of these searches end at the same cost
///    (three, if the residuals are not white), or six are done.
///
/// A cost that is zero to rounding (exact data) ends the search at once. The best point is then the start of
/// one local search without a limit. The stages are the ends of the independent starts, best first. What is
/// evaluated does not depend on the number of threads.
/// Source: Wales, Doye (1997), J. Phys. Chem. A 101:5111-5116; Boender, Rinnooy Kan (1987), Math. Programming
/// 37:59-80, on stopping rules that count how often minima are found.
class IndependentStarts : public Solver {
 public:
  explicit IndependentStarts(const SolverOptions& options) : options_(options) {}

  [[nodiscard]] bool ToleratesFailedStart() const override { return true; }

 private:
  Search DoSolve(Evaluator& evaluator, const Vector& start) const override;

  SolverOptions options_;
};

/// @param ends of independent starts, in any order; those without a cost count as starts
[[nodiscard]] Agreement AgreementOf(const std::vector<Stage>& ends);

/// "3 of 4 independent starts end at the lowest cost; the next best is 12 % worse". @param starts what they
/// are, in the plural
[[nodiscard]] std::string EndsOfStarts(const Agreement& agreement, const std::string& starts);

}  // namespace sinew::solvers
