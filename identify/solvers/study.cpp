#include "identify/solvers/study.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/constants.h"
#include "base/random.h"

namespace sinew {
namespace {

constexpr double kTargetShare = 1.01;   // success: within 1 % of the best cost that any solver found
constexpr long kDefaultBudget = 20000;  // evaluations of a run

Vector StartOf(const LeastSquares& problem, std::uint64_t seed, int repeat) {
  Vector start = problem.Start();
  if (repeat == 0) return start;
  Random random(Random::StreamSeed(seed, static_cast<std::uint64_t>(repeat)));
  for (double& x : start) x = random.Uniform();
  return start;
}

double Median(std::vector<double> values) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double v) { return std::isnan(v); }),
               values.end());
  if (values.empty()) return kNaN;
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

std::vector<StudyRun::Improvement> Improvements(const std::vector<TraceEntry>& trace) {
  std::vector<StudyRun::Improvement> improvements;
  double lowest = kInfinity;
  for (const TraceEntry& entry : trace) {
    if (!(entry.cost < lowest)) continue;
    lowest = entry.cost;
    improvements.push_back({entry.evaluation + 1, lowest, entry.seconds});
  }
  return improvements;
}

// The run of a comparison that is resumed, or nullptr.
const StudyRun* FindDone(const StudyOptions& options, const std::string& name, int repeat) {
  const std::uint64_t seed = options.solver_options.seed + static_cast<std::uint64_t>(repeat);
  const auto found = std::find_if(options.done.begin(), options.done.end(), [&](const StudyRun& run) {
    return run.solver == name && run.seed == seed;
  });
  return found == options.done.end() ? nullptr : &*found;
}

Result<StudyRun> RunOnce(const LeastSquares& problem, const StudyOptions& options, const std::string& name,
                         int repeat) {
  SolverOptions how = options.solver_options;
  how.seed += static_cast<std::uint64_t>(repeat);
  SINEW_ASSIGN(const auto solver, MakeSolver(name, how));
  Evaluator::Options evaluation;
  if (options.budget) {
    evaluation.budget = *options.budget;
  } else {
    evaluation.budget.max_evaluations = kDefaultBudget;
  }
  evaluation.interrupt = options.interrupt;
  Evaluator evaluator(problem, std::move(evaluation));
  const SolverResult result = solver->Solve(evaluator, StartOf(problem, options.solver_options.seed, repeat));
  StudyRun run{name,
               how.seed,
               result.stop,
               result.cost,
               evaluator.seconds(),
               evaluator.evaluations(),
               Improvements(evaluator.trace()),
               {},
               {}};
  if (result.stop.usable()) run.parameters = problem.Parameters(result.x);
  return run;
}

// Of an answer, before the start of the improvements.
constexpr std::size_t kRunNumbers = 5;

Answer ToAnswer(const StudyRun& run) {
  Answer answer;
  answer.numbers = {static_cast<double>(run.evaluations), run.cost, run.seconds,
                    static_cast<double>(static_cast<int>(run.stop.kind)),
                    static_cast<double>(run.parameters.size())};
  answer.numbers.insert(answer.numbers.end(), run.parameters.begin(), run.parameters.end());
  for (const StudyRun::Improvement& one : run.improvements)
    answer.numbers.insert(answer.numbers.end(), {static_cast<double>(one.evaluation), one.cost, one.seconds});
  answer.text = run.stop.test;
  return answer;
}

std::optional<StudyRun> RunFrom(const Answer& answer) {
  const std::vector<double>& numbers = answer.numbers;
  if (numbers.size() < kRunNumbers) return {};
  const auto head = kRunNumbers + static_cast<std::size_t>(numbers[4]);
  if (numbers.size() < head || (numbers.size() - head) % 3 != 0) return {};
  StudyRun run;
  run.evaluations = static_cast<long>(numbers[0]);
  run.cost = numbers[1];
  run.seconds = numbers[2];
  run.stop = {static_cast<Termination>(static_cast<int>(numbers[3])), answer.text};
  run.parameters =
      Eigen::Map<const Vector>(numbers.data() + kRunNumbers, static_cast<Eigen::Index>(head - kRunNumbers));
  for (std::size_t i = head; i < numbers.size(); i += 3)
    run.improvements.push_back({static_cast<long>(numbers[i]), numbers[i + 1], numbers[i + 2]});
  return run;
}

class Comparison {
 public:
  Comparison(const LeastSquares& problem, const StudyOptions& options)
      : problem_(problem), options_(options) {
    for (const std::string& name : options.solvers) {
      for (int repeat = 0; repeat < options.repeats; ++repeat) pieces_.push_back({name, repeat, {}, {}});
    }
  }

  Result<Study> Run() {
    ForEachShared(
        options_.work, Question(), 1, pieces_.size(),
        [&](std::size_t i, std::size_t) { return Do(pieces_[i]); },
        [&](std::size_t i, const Answer& answer) { return TakeOver(pieces_[i], answer); });
    Study study;
    study.free = problem_.setup().free;
    for (Piece& piece : pieces_) {
      SINEW_TRY(piece.status);
      if (!piece.run) {
        study.finished = false;
        continue;
      }
      piece.run->start = StartOf(problem_, options_.solver_options.seed, piece.repeat);
      if (piece.run->stop.usable()) study.best = std::min(study.best, piece.run->cost);
      study.runs.push_back(std::move(*piece.run));
    }
    study.target = options_.target.value_or(kTargetShare * study.best);
    return study;
  }

 private:
  struct Piece {
    std::string solver;
    int repeat = 0;
    std::optional<StudyRun> run;
    Status status;
  };

  [[nodiscard]] Digest Question() const {
    Digest question;
    problem_.AddTo(question);
    question.Add("comparison").Add(options_.solver_options.seed);
    for (const Piece& piece : pieces_)
      question.Add(piece.solver).Add(static_cast<std::uint64_t>(piece.repeat));
    return question;
  }

  [[nodiscard]] bool IsInterrupted() const {
    return options_.interrupt != nullptr && options_.interrupt->load();
  }

  Answer Do(Piece& piece) {
    if (const StudyRun* done = FindDone(options_, piece.solver, piece.repeat); done != nullptr) {
      piece.run = *done;
      Count();
      return {};
    }
    if (IsInterrupted()) return {};
    Result<StudyRun> run = RunOnce(problem_, options_, piece.solver, piece.repeat);
    if (!run) {
      piece.status = tl::unexpected(run.error());
      return {};
    }
    // Interrupted before it found an answer, a run stops as one without a prediction: no run either.
    if (run->stop.kind == Termination::kInterrupted || (IsInterrupted() && !run->stop.usable())) return {};
    if (options_.after_run) options_.after_run(*run);
    piece.run = std::move(*run);
    Count();
    return ToAnswer(*piece.run);
  }

  // What another process has run. @return false: it was interrupted there, or had been done before
  bool TakeOver(Piece& piece, const Answer& answer) {
    piece.run = RunFrom(answer);
    if (!piece.run) return false;
    piece.run->solver = piece.solver;
    piece.run->seed = options_.solver_options.seed + static_cast<std::uint64_t>(piece.repeat);
    if (options_.after_run) options_.after_run(*piece.run);
    Count();
    return true;
  }

  void Count() {
    ++done_;
    if (options_.progress) options_.progress(done_, static_cast<int>(pieces_.size()));
  }

  const LeastSquares& problem_;
  const StudyOptions& options_;
  std::vector<Piece> pieces_;
  int done_ = 0;
};

SolverSummary SummaryOf(const std::string& solver, const Study& study) {
  SolverSummary summary;
  summary.solver = solver;
  std::vector<double> cost, evaluations, to_target, seconds, seconds_to_target;
  std::vector<std::vector<double>> values(study.free.size());
  for (const StudyRun& run : study.runs) {
    if (run.solver != solver) continue;
    const StudyRun::Effort effort = run.ToTarget(study.target);
    ++summary.repeats;
    summary.successes += run.cost <= study.target ? 1 : 0;
    cost.push_back(run.cost);
    evaluations.push_back(static_cast<double>(run.evaluations));
    to_target.push_back(effort.evaluations);
    seconds.push_back(run.seconds);
    seconds_to_target.push_back(effort.seconds);
    for (std::size_t k = 0; k < study.free.size() && run.parameters.size() > 0; ++k)
      values[k].push_back(run.parameters[study.free[k]]);
  }
  summary.cost_median = Median(cost);
  summary.cost_worst = *std::max_element(cost.begin(), cost.end());
  summary.evaluations = Median(evaluations);
  summary.evaluations_to_target = Median(to_target);
  summary.seconds = Median(seconds);
  summary.seconds_to_target = Median(seconds_to_target);
  for (const auto& v : values) {
    double mean = 0;
    double squares = 0;
    for (const double value : v) mean += value / static_cast<double>(v.size());
    for (const double value : v) squares += (value - mean) * (value - mean);
    summary.mean.push_back(v.empty() ? kNaN : mean);
    summary.deviation.push_back(v.size() < 2 ? 0 : std::sqrt(squares / static_cast<double>(v.size() - 1)));
  }
  return summary;
}

}  // namespace

StudyRun::Effort StudyRun::ToTarget(double target) const {
  for (const Improvement& better : improvements) {
    if (better.cost <= target) return {static_cast<double>(better.evaluation), better.seconds};
  }
  return {kNaN, kNaN};
}

Result<Study> CompareSolvers(const LeastSquares& problem, const StudyOptions& options) {
  for (const std::string& name : options.solvers) {
    SINEW_TRY(MakeSolver(name, options.solver_options));
    if (std::count(options.solvers.begin(), options.solvers.end(), name) > 1)
      return Fail("solver '{}' is named twice", name);
  }
  return Comparison(problem, options).Run();
}

std::vector<SolverSummary> Summarise(const Study& study) {
  std::vector<SolverSummary> summaries;
  for (const StudyRun& run : study.runs) {
    const bool is_there = std::any_of(summaries.begin(), summaries.end(),
                                      [&](const SolverSummary& s) { return s.solver == run.solver; });
    if (!is_there) summaries.push_back(SummaryOf(run.solver, study));
  }
  return summaries;
}

}  // namespace sinew
