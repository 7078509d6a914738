#include "identify/solvers/polishing.h"

#include <atomic>
#include <memory>
#include <mutex>

#include "identify/execution/executor.h"

namespace sinew::solvers {
namespace {

class Polishing {
 public:
  Polishing(Evaluator& parent, const Solver& solver, const std::string& name,
            const std::vector<PolishingStart>& starts)
      : parent_(parent), solver_(solver), name_(name), starts_(starts), tasks_(starts.size()) {}

  std::vector<Polished> Run(int threads) {
    const auto executor = MakeExecutor(threads);
    executor->ForEach(executor->workers(), [&](std::size_t, std::size_t) {
      for (std::size_t i = next_++; i < starts_.size() && !ended_; i = next_++) Polish(i);
    });
    std::vector<Polished> polished;
    for (std::size_t i = 0; i < absorbed_; ++i) polished.push_back(std::move(tasks_[i].polished));
    return polished;
  }

 private:
  struct Task {
    std::unique_ptr<Evaluator> evaluator;
    Polished polished;
    bool done = false;
  };

  void Polish(std::size_t i) {
    Task& task = tasks_[i];
    Evaluator::Options options;
    options.budget = {starts_[i].evaluations, parent_.options().budget.max_seconds};
    options.target_cost = parent_.options().target_cost;
    options.interrupt = parent_.options().interrupt;
    options.began = parent_.options().began;
    task.evaluator = std::make_unique<Evaluator>(parent_.fit(), std::move(options));
    if (const FinishedSearch* done = parent_.FindFinished(name_, starts_[i].x, starts_[i].evaluations)) {
      task.evaluator->Restore(parent_, *done);
      task.polished = {
          {name_,
           {TerminationOf(done->stop_kind).value_or(Termination::kSolverFailed), done->stop_test},
           done->evaluations,
           done->cost,
           done->x},
          done->iterations};
    } else {
      const SolverResult result = solver_.Solve(*task.evaluator, starts_[i].x);
      task.polished = {{name_, result.stop, task.evaluator->evaluations(), result.cost, result.x},
                       result.iterations};
    }

    const std::lock_guard<std::mutex> lock(absorb_);
    task.done = true;
    while (!ended_ && absorbed_ < starts_.size() && tasks_[absorbed_].done) {
      Absorb(absorbed_);
      tasks_[absorbed_++].evaluator.reset();
      ended_ = parent_.has_best() && parent_.best().cost <= parent_.options().target_cost;
    }
  }

  // A search that a limit of the whole run or a signal has ended is not at its end.
  void Absorb(std::size_t i) {
    const Stage& stage = tasks_[i].polished.stage;
    const Evaluator::StopCause cause = tasks_[i].evaluator->stop_cause();
    const bool cut_short =
        cause == Evaluator::StopCause::kInterrupted || cause == Evaluator::StopCause::kSeconds;
    const bool has_point = stage.x.size() == starts_[i].x.size();
    if (cut_short || !has_point) return parent_.Absorb(*tasks_[i].evaluator);
    FinishedSearch search;
    search.solver = name_;
    search.start = starts_[i].x;
    search.max_evaluations = starts_[i].evaluations;
    search.stop_kind = ToString(stage.stop.kind);
    search.stop_test = stage.stop.test;
    search.cost = stage.cost;
    search.x = stage.x;
    search.iterations = tasks_[i].polished.iterations;
    parent_.AbsorbFinished(*tasks_[i].evaluator, std::move(search));
  }

  Evaluator& parent_;
  const Solver& solver_;
  const std::string& name_;
  const std::vector<PolishingStart>& starts_;
  std::vector<Task> tasks_;
  std::atomic<std::size_t> next_ = 0;
  std::mutex absorb_;
  std::size_t absorbed_ = 0;
  std::atomic<bool> ended_ = false;
};

}  // namespace

std::vector<PolishingStart> EqualShares(const std::vector<Vector>& points, long budget) {
  const auto count = static_cast<long>(points.size());
  const bool unlimited = budget > kUnlimitedEvaluations / 2;
  std::vector<PolishingStart> starts;
  for (long i = 0; i < count; ++i) {
    starts.push_back({points[static_cast<std::size_t>(i)],
                      unlimited ? kUnlimitedEvaluations : budget / count + (i < budget % count ? 1 : 0)});
  }
  return starts;
}

std::vector<Polished> PolishAll(Evaluator& parent, const Solver& solver, const std::string& name,
                                const std::vector<PolishingStart>& starts, int threads) {
  return Polishing(parent, solver, name, starts).Run(threads);
}

}  // namespace sinew::solvers
