#include "identify/solvers/stated_starts.h"

#include <algorithm>

#include "identify/solvers/independent_starts.h"
#include "identify/solvers/levenberg_marquardt.h"
#include "identify/solvers/polishing.h"

namespace sinew::solvers {
namespace {

std::vector<Vector> StartsOf(const LeastSquares& fit, const Vector& given) {
  std::vector<Vector> starts{given};
  for (const int index : fit.setup().free) {
    const Parameter& parameter = fit.setup().parameters[static_cast<std::size_t>(index)];
    for (const double other : parameter.other_starts) {
      Vector values = fit.Parameters(given);
      if (values[index] == other) continue;
      values[index] = other;
      starts.push_back(fit.Variables(values));
    }
  }
  return starts;
}

}  // namespace

Search StatedStarts::DoSolve(Evaluator& evaluator, const Vector& start) const {
  const std::vector<PolishingStart> starts =
      EqualShares(StartsOf(evaluator.fit(), start), evaluator.remaining().max_evaluations);
  Search search;
  bool all = true;
  for (Polished& one :
       PolishAll(evaluator, LevenbergMarquardt(options_.cost_tolerance), "lm", starts, options_.threads)) {
    search.iterations += one.iterations;
    all = all && (one.stage.stop.converged() || !one.stage.stop.usable());
    search.stages.push_back(std::move(one.stage));
  }
  if (search.stages.size() == 1) {
    search.stop = search.stages.front().stop;
    search.stages.clear();
    evaluator.MustStop();
    return search;
  }
  if (!search.stages.empty() && evaluator.has_best()) {
    const Stage& given = search.stages.front();
    if (given.cost <= (1 + kTie) * evaluator.best().cost) search.answer = {0, given.cost, given.x};
  }
  std::stable_sort(search.stages.begin(), search.stages.end(),
                   [](const Stage& a, const Stage& b) { return a.cost < b.cost; });
  search.stop.kind = all && search.stages.size() == starts.size() ? Termination::kStartsDone
                                                                  : Termination::kStartsUnfinished;
  search.stop.test = EndsOfStarts(AgreementOf(search.stages), "stated starts of local searches");
  evaluator.MustStop();
  return search;
}

}  // namespace sinew::solvers
