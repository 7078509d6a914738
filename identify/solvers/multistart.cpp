#include "identify/solvers/multistart.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <memory>
#include <mutex>
#include <numeric>

#include "base/random.h"
#include "identify/solvers/ceres_solver.h"

namespace sinew {
namespace {

constexpr long kUnlimited = std::numeric_limits<long>::max();
// Fewer evaluations do not polish anything.
constexpr long kSmallestShare = 20;

struct Start {
  Vector x;
  long share = kUnlimited;
  std::unique_ptr<Evaluator> evaluator;
  SolverResult result;
  long evaluations = 0;
  bool done = false;
};

std::vector<Start> MakeStarts(const Vector& first, int count, long budget, std::uint64_t seed) {
  if (budget != kUnlimited) count = static_cast<int>(std::clamp<long>(budget / kSmallestShare, 1, count));
  std::vector<Start> starts(static_cast<std::size_t>(count));
  starts.front().x = first;
  const std::vector<Vector> others = LatinHypercube(count - 1, static_cast<int>(first.size()), seed);
  for (int i = 1; i < count; ++i)
    starts[static_cast<std::size_t>(i)].x = others[static_cast<std::size_t>(i - 1)];
  if (budget == kUnlimited) return starts;
  for (int i = 0; i < count; ++i) {
    starts[static_cast<std::size_t>(i)].share = budget / count + (i < budget % count ? 1 : 0);
  }
  return starts;
}

// Searches from every start and hands the evaluations to the parent, in order, as soon as that is possible.
class Polishing {
 public:
  Polishing(Evaluator& parent, std::vector<Start>& starts, double cost_tolerance)
      : parent_(parent), starts_(starts), polish_(cost_tolerance) {}

  void Run(int threads) {
    tbb::task_arena arena(threads);
    arena.execute([&] {
      tbb::parallel_for(0, threads, [&](int /*worker*/) {
        for (std::size_t i = next_++; i < starts_.size() && !ended_; i = next_++) Polish(i);
      });
    });
  }

  [[nodiscard]] std::size_t absorbed() const { return absorbed_; }

 private:
  void Polish(std::size_t i) {
    Start& start = starts_[i];
    Evaluator::Options options;
    options.budget = {start.share, parent_.options().budget.max_seconds};
    options.target_cost = parent_.options().target_cost;
    options.interrupt = parent_.options().interrupt;
    options.began = parent_.options().began;
    start.evaluator = std::make_unique<Evaluator>(parent_.problem(), std::move(options));
    start.result = polish_.Solve(*start.evaluator, start.x);
    start.evaluations = start.evaluator->evaluations();

    const std::lock_guard<std::mutex> lock(absorb_);
    start.done = true;
    while (!ended_ && absorbed_ < starts_.size() && starts_[absorbed_].done) {
      parent_.Absorb(*starts_[absorbed_].evaluator);
      starts_[absorbed_++].evaluator.reset();
      ended_ = parent_.has_best() && parent_.best().cost <= parent_.options().target_cost;
    }
  }

  Evaluator& parent_;
  std::vector<Start>& starts_;
  CeresSolver polish_;
  std::atomic<std::size_t> next_ = 0;
  std::mutex absorb_;
  std::size_t absorbed_ = 0;
  std::atomic<bool> ended_ = false;
};

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
  std::vector<Start> starts = MakeStarts(start, options_.starts,
                                         evaluator.options().budget.max_evaluations == kUnlimited
                                             ? kUnlimited
                                             : evaluator.remaining().max_evaluations,
                                         options_.seed);
  Polishing polishing(evaluator, starts, options_.cost_tolerance);
  polishing.Run(options_.threads);

  Search search;
  int converged = 0;
  int failed = 0;
  for (std::size_t i = 0; i < polishing.absorbed(); ++i) {
    const SolverResult& result = starts[i].result;
    search.iterations += result.iterations;
    converged += result.stop.converged() ? 1 : 0;
    failed += result.stop.usable() ? 0 : 1;
    search.stages.push_back({"ceres", result.stop, starts[i].evaluations, result.cost, result.x});
  }
  std::stable_sort(search.stages.begin(), search.stages.end(),
                   [](const Stage& a, const Stage& b) { return a.cost < b.cost; });
  const int asked = options_.starts;
  search.stop.test = fmt::format(
      "{} of {} starts: {} converged, {} without prediction, {} ran out of budget or "
      "were stopped by the solver",
      polishing.absorbed(), asked, converged, failed,
      static_cast<int>(polishing.absorbed()) - converged - failed);
  const bool all = static_cast<int>(polishing.absorbed()) == asked && converged + failed == asked;
  search.stop.kind = all ? Termination::kStartsDone : Termination::kMaxEvaluations;
  evaluator.MustStop();
  return search;
}

}  // namespace sinew
