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
    const SolverResult result = solver_.Solve(*task.evaluator, starts_[i].x);
    task.polished = {{name_, result.stop, task.evaluator->evaluations(), result.cost, result.x},
                     result.iterations};

    const std::lock_guard<std::mutex> lock(absorb_);
    task.done = true;
    while (!ended_ && absorbed_ < starts_.size() && tasks_[absorbed_].done) {
      parent_.Absorb(*tasks_[absorbed_].evaluator);
      tasks_[absorbed_++].evaluator.reset();
      ended_ = parent_.has_best() && parent_.best().cost <= parent_.options().target_cost;
    }
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

std::vector<Polished> PolishAll(Evaluator& parent, const Solver& solver, const std::string& name,
                                const std::vector<PolishingStart>& starts, int threads) {
  return Polishing(parent, solver, name, starts).Run(threads);
}

}  // namespace sinew::solvers
