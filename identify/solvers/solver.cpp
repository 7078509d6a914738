#include "identify/solvers/solver.h"

#include <cmath>
#include <limits>

#include "base/constants.h"
#include "base/numbers.h"
#include "base/text.h"

namespace sinew {
namespace {

// A solver of a chain starts at the best point of the one before: that point is not predicted again.
bool IsEvaluated(const Evaluator& evaluator, const Vector& x) {
  if (evaluator.has_best() && evaluator.best().x == x) return true;
  return !evaluator.trace().empty() && evaluator.trace().front().x == x;
}

// "ipopt, nlopt:LD_SLSQP"
std::string ConstrainedSolvers() {
  std::vector<std::string> names;
  for (const SolverEntry& entry : SolverRegistry()) {
    if (entry.constraints) names.push_back(entry.name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

const Vector& FirstFailure(const Evaluator& evaluator) {
  for (const TraceEntry& entry : evaluator.trace()) {
    if (!std::isfinite(entry.cost)) return entry.x;
  }
  return evaluator.trace().front().x;
}

// "stiffness = 9e5 N/m3, dissipation = 30 s/m", of the free parameters.
std::string PointText(const Evaluator& evaluator, const Vector& x) {
  constexpr std::size_t kMostShown = 8;
  const FitSetup& setup = evaluator.fit().setup();
  const Vector parameters = evaluator.fit().Parameters(x);
  std::vector<std::string> values;
  for (const int index : setup.free) {
    const Parameter& p = setup.parameters[static_cast<std::size_t>(index)];
    if (values.size() == kMostShown) {
      values.push_back(fmt::format("... ({} in all)", setup.free.size()));
      break;
    }
    values.push_back(
        fmt::format("{} = {}{}", p.name, Readable(parameters[index], 4), p.unit == "1" ? "" : " " + p.unit));
  }
  return values.empty() ? "the start" : Join(values, ", ");
}

Stop StopWithoutAnswer(const Evaluator& evaluator) {
  if (evaluator.trace().empty()) {
    return {Termination::kNoPrediction, "not even the start was evaluated: " + StopFrom(evaluator).test};
  }
  if (evaluator.infeasible() > 0) {
    const auto violated = evaluator.Violated(evaluator.trace().front().x);
    return {Termination::kInfeasible,
            fmt::format("{} of {} points violate a constraint, no other has a cost{}", evaluator.infeasible(),
                        evaluator.evaluations(),
                        violated ? fmt::format("; the start violates '{}': begin elsewhere, or with a solver "
                                               "that searches along constraints ({})",
                                               *violated, ConstrainedSolvers())
                                 : "")};
  }
  const auto reasons = evaluator.record().reasons().MostFrequentFirst();
  std::string more;
  for (const FailureReason& reason : reasons) {
    if (reasons.size() > 1)
      more += fmt::format("{}{} because {}", more.empty() ? "; " : ", ", reason.count, reason.message);
  }
  return {Termination::kNoPrediction,
          fmt::format("{} of {} points have no prediction; the first, at {}: {}{}", evaluator.failures(),
                      evaluator.evaluations(), PointText(evaluator, FirstFailure(evaluator)),
                      evaluator.first_failure(), more)};
}

}  // namespace

const char* ToString(Termination termination) {
  switch (termination) {
    case Termination::kCostChange:
      return "cost_change";
    case Termination::kGradient:
      return "gradient";
    case Termination::kStepSize:
      return "step_size";
    case Termination::kAnnealed:
      return "annealed";
    case Termination::kStartsDone:
      return "starts_done";
    case Termination::kStartsUnfinished:
      return "starts_unfinished";
    case Termination::kTarget:
      return "target";
    case Termination::kNothingFree:
      return "nothing_free";
    case Termination::kMaxEvaluations:
      return "max_evaluations";
    case Termination::kMaxSeconds:
      return "max_seconds";
    case Termination::kMaxMemory:
      return "max_memory";
    case Termination::kInterrupted:
      return "interrupted";
    case Termination::kSolverFailed:
      return "solver_failed";
    case Termination::kInfeasible:
      return "infeasible";
    case Termination::kNoPrediction:
      return "no_prediction";
  }
  return "?";
}

std::optional<Termination> TerminationOf(const std::string& name) {
  for (int kind = 0; kind <= static_cast<int>(Termination::kNoPrediction); ++kind) {
    if (name == ToString(static_cast<Termination>(kind))) return static_cast<Termination>(kind);
  }
  return std::nullopt;
}

bool Stop::converged() const {
  switch (kind) {
    case Termination::kCostChange:
    case Termination::kGradient:
    case Termination::kStepSize:
    case Termination::kAnnealed:
    case Termination::kStartsDone:
    case Termination::kTarget:
    case Termination::kNothingFree:
      return true;
    default:
      return false;
  }
}

Stop StopFrom(const Evaluator& evaluator) {
  switch (evaluator.stop_cause()) {
    case Evaluator::StopCause::kEvaluations:
      return {Termination::kMaxEvaluations, fmt::format("{} evaluations, {} left", evaluator.evaluations(),
                                                        evaluator.remaining().max_evaluations)};
    case Evaluator::StopCause::kSeconds:
      return {Termination::kMaxSeconds, fmt::format("{:.3g} s >= {:.3g} s", evaluator.seconds(),
                                                    evaluator.options().budget.max_seconds)};
    case Evaluator::StopCause::kMemory:
      return {Termination::kMaxMemory,
              fmt::format("the process takes the {:.4g} MB of memory that it may; --resume with more goes on",
                          evaluator.options().budget.max_memory / 1e6)};
    case Evaluator::StopCause::kInterrupted:
      return {Termination::kInterrupted,
              fmt::format("interrupted after {} evaluations", evaluator.evaluations())};
    case Evaluator::StopCause::kTarget:
      return {Termination::kTarget,
              fmt::format("cost {:.6g} <= {:.6g}", evaluator.best().cost, evaluator.options().target_cost)};
    case Evaluator::StopCause::kNone:
      break;
  }
  return {Termination::kSolverFailed, "the search ended without a reason"};
}

bool Solver::CanBegin(const Evaluator& evaluator, const Vector& start) const {
  if (evaluator.has_best()) return true;
  return evaluator.Violated(start) ? ToleratesInfeasibleStart() : ToleratesFailedStart();
}

SolverResult Solver::Solve(Evaluator& evaluator, const Vector& start) const {
  SolverResult result;
  TraceEntry answer;
  double cost = kInfinity;
  if (!IsEvaluated(evaluator, start)) evaluator.Cost(start, cost);

  const bool evaluated = IsEvaluated(evaluator, start);
  if (evaluated && evaluator.fit().variables() == 0) {
    result.stop = {Termination::kNothingFree, "no parameter is free; the start was evaluated"};
  } else if (!evaluator.MustStop() && CanBegin(evaluator, start)) {
    Search search = DoSolve(evaluator, start);
    result.stop = std::move(search.stop);
    result.iterations = search.iterations;
    result.stages = std::move(search.stages);
    answer = std::move(search.answer);
  }
  if (evaluator.stop_cause() != Evaluator::StopCause::kNone) result.stop = StopFrom(evaluator);

  if (!evaluator.has_best()) {
    result.stop = StopWithoutAnswer(evaluator);
    result.x = start;
    result.cost = kInfinity;
    return result;
  }
  if (answer.x.size() == 0) answer = evaluator.best();
  result.x = answer.x;
  result.cost = answer.cost;
  return result;
}

}  // namespace sinew
