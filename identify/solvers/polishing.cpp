#include "identify/solvers/polishing.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string_view>
#include <utility>

#include "base/text.h"
#include "identify/execution/fit_record.h"
#include "identify/execution/shared_loop.h"

namespace sinew::solvers {
namespace {

// Of the answer of a search, before its end: evaluations, failures, infeasible points, cost, iterations.
// After it, for each evaluation its time, cost and point.
constexpr std::size_t kSearchNumbers = 5;

class Polishing {
 public:
  Polishing(Evaluator& parent, const Solver& solver, const std::string& name,
            const std::vector<PolishingStart>& starts)
      : parent_(parent), solver_(solver), name_(name), starts_(starts), tasks_(starts.size()) {}

  std::vector<Polished> Run(int threads) {
    const FitRecord* record = parent_.fit().setup().record;
    const SharedWork work = record == nullptr ? SharedWork() : record->shared;
    answers_ = work.ranks != nullptr;
    ForEachShared(
        work, answers_ ? Question() : Digest(), threads, starts_.size(),
        [&](std::size_t i, std::size_t) { return Polish(i); },
        [&](std::size_t i, const Answer& answer) { return TakeOver(i, answer); });
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

  [[nodiscard]] Digest Question() const {
    Digest question;
    parent_.fit().AddTo(question);
    question.Add("searches").Add(name_);
    for (const PolishingStart& start : starts_) {
      question.Add(start.x.data(), static_cast<std::size_t>(start.x.size()));
      question.Add(static_cast<std::uint64_t>(start.evaluations));
    }
    return question;
  }

  void NewEvaluator(std::size_t i) {
    Evaluator::Options options;
    options.budget = parent_.options().budget;
    options.budget.max_evaluations = starts_[i].evaluations;
    options.most_entries = parent_.options().most_entries;
    options.target_cost = parent_.options().target_cost;
    options.interrupt = parent_.options().interrupt;
    options.began = parent_.options().began;
    tasks_[i].evaluator = std::make_unique<Evaluator>(parent_.fit(), std::move(options));
  }

  Answer Polish(std::size_t i) {
    if (ended_) return {};
    NewEvaluator(i);
    Task& task = tasks_[i];
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
    Answer answer;
    // One so long that not all of its points are there is made by every process.
    if (answers_ && IsFinished(i) && !task.evaluator->record().thinned()) answer = ToAnswer(i);
    AbsorbWhatIsDone(i);
    return answer;
  }

  // A search that a limit of the whole run or a signal has ended is not at its end.
  [[nodiscard]] bool IsFinished(std::size_t i) const {
    const Evaluator::StopCause cause = tasks_[i].evaluator->stop_cause();
    return cause != Evaluator::StopCause::kInterrupted && cause != Evaluator::StopCause::kSeconds &&
           cause != Evaluator::StopCause::kMemory && tasks_[i].polished.stage.x.size() == starts_[i].x.size();
  }

  [[nodiscard]] Answer ToAnswer(std::size_t i) const {
    const Evaluator& evaluator = *tasks_[i].evaluator;
    const Stage& stage = tasks_[i].polished.stage;
    Answer answer;
    answer.numbers = {static_cast<double>(evaluator.evaluations()), static_cast<double>(evaluator.failures()),
                      static_cast<double>(evaluator.infeasible()), stage.cost,
                      static_cast<double>(tasks_[i].polished.iterations)};
    answer.numbers.insert(answer.numbers.end(), stage.x.begin(), stage.x.end());
    std::vector<std::string> texts{ToString(stage.stop.kind), OneLine(stage.stop.test),
                                   OneLine(evaluator.first_failure())};
    for (const TraceEntry& entry : evaluator.trace()) {
      answer.numbers.push_back(entry.seconds);
      answer.numbers.push_back(entry.cost);
      answer.numbers.insert(answer.numbers.end(), entry.x.begin(), entry.x.end());
      if (!std::isfinite(entry.cost)) texts.push_back(OneLine(entry.failure));
    }
    answer.text = Join(texts, "\n");
    return answer;
  }

  static std::string OneLine(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
  }

  // What another process has found. @return false: it did not come to its end there
  bool TakeOver(std::size_t i, const Answer& answer) {
    const auto n = starts_[i].x.size();
    const auto width = static_cast<std::size_t>(n) + 2;
    const std::size_t head = kSearchNumbers + static_cast<std::size_t>(n);
    if (answer.numbers.size() < head) return ended_;
    FinishedSearch search;
    search.evaluations = static_cast<long>(answer.numbers[0]);
    search.failures = static_cast<long>(answer.numbers[1]);
    search.infeasible = static_cast<long>(answer.numbers[2]);
    search.cost = answer.numbers[3];
    search.iterations = static_cast<int>(answer.numbers[4]);
    const std::vector<std::string_view> texts = Split(answer.text, '\n');
    if (answer.numbers.size() != head + width * static_cast<std::size_t>(search.evaluations) ||
        texts.size() < 3)
      return false;
    search.stop_kind = texts[0];
    search.stop_test = texts[1];
    search.first_failure = texts[2];
    search.x = Eigen::Map<const Vector>(answer.numbers.data() + kSearchNumbers, n);
    std::vector<TraceEntry> trace;
    std::size_t failure = 3;
    for (const double* at = answer.numbers.data() + head; at != answer.numbers.data() + answer.numbers.size();
         at += width) {
      trace.push_back({at[0], at[1], Eigen::Map<const Vector>(at + 2, n), {}});
      if (!std::isfinite(at[1]) && failure < texts.size()) trace.back().failure = texts[failure++];
    }
    NewEvaluator(i);
    tasks_[i].evaluator->Restore(SearchRecord::OfAll(std::move(trace)), search);
    tasks_[i].polished = {
        {name_,
         {TerminationOf(search.stop_kind).value_or(Termination::kSolverFailed), search.stop_test},
         search.evaluations,
         search.cost,
         search.x},
        search.iterations};
    AbsorbWhatIsDone(i);
    return true;
  }

  void AbsorbWhatIsDone(std::size_t i) {
    const std::lock_guard<std::mutex> lock(absorb_);
    tasks_[i].done = true;
    while (!ended_ && absorbed_ < starts_.size() && tasks_[absorbed_].done) {
      Absorb(absorbed_);
      tasks_[absorbed_++].evaluator.reset();
      ended_ = parent_.has_best() && parent_.best().cost <= parent_.options().target_cost;
    }
  }

  void Absorb(std::size_t i) {
    if (!IsFinished(i)) return parent_.Absorb(*tasks_[i].evaluator);
    const Stage& stage = tasks_[i].polished.stage;
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
  bool answers_ = false;  // are wanted by other processes
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
