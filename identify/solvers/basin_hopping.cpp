#include "identify/solvers/basin_hopping.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/random.h"
#include "identify/solvers/displacement.h"
#include "identify/solvers/levenberg_marquardt.h"
#include "identify/solvers/polishing.h"

namespace sinew::solvers {
namespace {

constexpr int kHopsAtOnce = 4;
// A local search that has not reached a lower cost after this many evaluations rarely does; the next
// displacement is more likely to.
constexpr long kEvaluationsPerHop = 60;
constexpr double kImprovement = 1e-3;

}  // namespace

Search BasinHopping::DoSolve(Evaluator& evaluator, const Vector& start) const {
  const LevenbergMarquardt local(options_.cost_tolerance);
  const StartSampler sampler(evaluator.fit());
  Random random(options_.seed);
  Search search;
  int hops = 0;
  int without_gain = 0;
  const auto polish = [&](const std::vector<PolishingStart>& starts) {
    for (Polished& one : PolishAll(evaluator, local, "lm", starts, options_.threads)) {
      search.iterations += one.iterations;
      search.stages.push_back(std::move(one.stage));
    }
  };
  polish({{start, std::min(kEvaluationsPerHop, evaluator.remaining().max_evaluations)}});
  if (!evaluator.has_best()) {
    std::vector<PolishingStart> starts;
    long left = evaluator.remaining().max_evaluations;
    for (Vector& x : sampler.Anywhere(start, options_.starts, options_.seed)) {
      if (left <= 0) break;
      starts.push_back({std::move(x), std::min(kEvaluationsPerHop, left)});
      left -= starts.back().evaluations;
    }
    polish(starts);
  }
  while (evaluator.has_best() && without_gain < options_.starts && !evaluator.MustStop()) {
    const double before = evaluator.best().cost;
    std::vector<PolishingStart> starts;
    long left = evaluator.remaining().max_evaluations;
    for (int i = 0; i < kHopsAtOnce && left > 0; ++i) {
      starts.push_back({sampler.Near(evaluator.best().x, random), std::min(kEvaluationsPerHop, left)});
      left -= starts.back().evaluations;
    }
    polish(starts);
    hops += static_cast<int>(starts.size());
    const bool better = evaluator.best().cost < (1 - kImprovement) * before;
    without_gain = better ? 0 : without_gain + static_cast<int>(starts.size());
  }
  if (evaluator.has_best() && !evaluator.MustStop())
    polish({{evaluator.best().x, evaluator.remaining().max_evaluations}});
  std::stable_sort(search.stages.begin(), search.stages.end(),
                   [](const Stage& a, const Stage& b) { return a.cost < b.cost; });
  search.stop = {Termination::kStartsDone,
                 fmt::format("{} hops, the last {} gained less than {:.1g} of the cost", hops, without_gain,
                             kImprovement)};
  evaluator.MustStop();
  return search;
}

}  // namespace sinew::solvers
