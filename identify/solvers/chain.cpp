#include "identify/solvers/chain.h"

#include <limits>

namespace sinew::solvers {
namespace {

// Four fifths in equal parts to the solvers before the last: a final local search needs few evaluations, but
// it must get these.
long ShareOfLink(long remaining, std::size_t links_left) {
  const long earlier_links = static_cast<long>(links_left) - 1;
  return earlier_links == 0 ? remaining : (remaining - remaining / 5) / earlier_links;
}

}  // namespace

Search Chain::DoSolve(Evaluator& evaluator, const Vector& start) const {
  Search search;
  Vector from = start;
  const bool limited = evaluator.options().budget.max_evaluations != kUnlimitedEvaluations;
  for (std::size_t i = 0; i < links_.size(); ++i) {
    if (i > 0 && evaluator.MustStop()) break;
    const long before = evaluator.evaluations();
    if (limited) {
      evaluator.BeginShare(ShareOfLink(evaluator.remaining().max_evaluations, links_.size() - i));
    }
    SolverResult result = links_[i].solver->Solve(evaluator, from);
    if (limited) evaluator.EndShare();

    search.stop = result.stop;
    search.iterations += result.iterations;
    search.stages.push_back(
        {links_[i].name, result.stop, evaluator.evaluations() - before, result.cost, result.x});
    from = result.x;
    if (!result.stop.usable()) break;
  }
  return search;
}

}  // namespace sinew::solvers
