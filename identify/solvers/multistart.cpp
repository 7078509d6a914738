#include "identify/solvers/multistart.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "base/random.h"
#include "identify/solvers/ceres_solver.h"
#include "identify/solvers/polishing.h"

namespace sinew::solvers {
namespace {

// Least evaluations of a useful local search.
constexpr long kSmallestShare = 20;

std::vector<PolishingStart> MakeStarts(const Vector& first, int count, long budget, std::uint64_t seed) {
  if (budget < kUnlimitedEvaluations / 2)
    count = static_cast<int>(std::clamp<long>(budget / kSmallestShare, 1, count));
  std::vector<Vector> points = LatinHypercube(count - 1, static_cast<int>(first.size()), seed);
  points.insert(points.begin(), first);
  return EqualShares(points, budget);
}

}  // namespace

std::vector<Vector> LatinHypercube(int count, int variables, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vector> points(static_cast<std::size_t>(count), Vector(variables));
  std::vector<int> interval(static_cast<std::size_t>(count));
  for (int k = 0; k < variables; ++k) {
    std::iota(interval.begin(), interval.end(), 0);
    for (std::size_t i = interval.size(); i > 1; --i) std::swap(interval[i - 1], interval[random.Index(i)]);
    for (std::size_t i = 0; i < points.size(); ++i) points[i][k] = (interval[i] + random.Uniform()) / count;
  }
  return points;
}

Search MultiStart::DoSolve(Evaluator& evaluator, const Vector& start) const {
  const std::vector<PolishingStart> starts =
      MakeStarts(start, options_.starts, evaluator.remaining().max_evaluations, options_.seed);
  const std::vector<Polished> polished =
      PolishAll(evaluator, CeresSolver(options_.cost_tolerance), "ceres", starts, options_.threads);

  Search search;
  int converged = 0;
  int failed = 0;
  for (const Polished& one : polished) {
    search.iterations += one.iterations;
    converged += one.stage.stop.converged() ? 1 : 0;
    failed += one.stage.stop.usable() ? 0 : 1;
    search.stages.push_back(one.stage);
  }
  std::stable_sort(search.stages.begin(), search.stages.end(),
                   [](const Stage& a, const Stage& b) { return a.cost < b.cost; });
  const int asked = options_.starts;
  search.stop.test = fmt::format(
      "{} of {} starts: {} converged, {} without prediction, {} ran out of budget or "
      "were stopped by the solver",
      polished.size(), asked, converged, failed, static_cast<int>(polished.size()) - converged - failed);
  const bool all = static_cast<int>(polished.size()) == asked && converged + failed == asked;
  search.stop.kind = all ? Termination::kStartsDone : Termination::kStartsUnfinished;
  evaluator.MustStop();
  return search;
}

}  // namespace sinew::solvers
