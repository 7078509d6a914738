#include "identify/execution/evaluator.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <utility>

#include "base/constants.h"
#include "base/process_memory.h"

namespace sinew {
namespace {

// A constraint counts as satisfied up to this share of the size of its terms, which allows for rounding and
// for the final tolerance of an interior-point method.
constexpr double kConstraintTolerance = 1e-9;
constexpr double kBetweenLooksAtMemory = 0.02;  // [s]; a look takes 20 us

}  // namespace

Evaluator::Evaluator(const LeastSquares& fit, Options options)
    : fit_(fit),
      options_(std::move(options)),
      workspace_(fit.NewWorkspace()),
      gradient_jacobian_(fit.NewJacobian()),
      record_(options_.most_entries) {
  if (options_.watch == nullptr) return;
  const std::lock_guard lock(options_.watch->mutex);
  options_.watch->running = this;
}

Evaluator::~Evaluator() {
  if (options_.watch == nullptr) return;
  const std::lock_guard lock(options_.watch->mutex);
  if (options_.watch->running == this) options_.watch->running = nullptr;
}

SearchRecord Evaluator::TakeRecord() {
  const auto lock = LockRecord();
  if (options_.watch != nullptr) options_.watch->running = nullptr;
  return std::exchange(record_, SearchRecord(options_.most_entries));
}

std::unique_lock<std::mutex> Evaluator::LockRecord() const {
  return options_.watch == nullptr ? std::unique_lock<std::mutex>()
                                   : std::unique_lock<std::mutex>(options_.watch->mutex);
}

double Evaluator::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - options_.began).count();
}

Budget Evaluator::remaining() const {
  return {evaluation_limit() - evaluations(), options_.budget.max_seconds - seconds(),
          options_.budget.max_memory};
}

long Evaluator::evaluation_limit() const {
  return std::min(options_.budget.max_evaluations, share_end_);
}

void Evaluator::BeginShare(long evaluations_allowed) {
  share_end_ = evaluations() + evaluations_allowed;
}

void Evaluator::EndShare() {
  share_end_ = std::numeric_limits<long>::max();
  if (stop_cause_ == StopCause::kEvaluations) stop_cause_ = StopCause::kNone;
}

bool Evaluator::NeedsMuchMemory() {
  if (!std::isfinite(options_.budget.max_memory) || seconds() < next_look_at_memory_) return false;
  next_look_at_memory_ = seconds() + kBetweenLooksAtMemory;
  return static_cast<double>(ResidentMemory()) >= options_.budget.max_memory;
}

bool Evaluator::MustStop() {
  if (stop_cause_ != StopCause::kNone) return true;
  if (evaluations() >= evaluation_limit()) stop_cause_ = StopCause::kEvaluations;
  if (std::isfinite(options_.budget.max_seconds) && seconds() >= options_.budget.max_seconds) {
    stop_cause_ = StopCause::kSeconds;
  }
  if (NeedsMuchMemory()) stop_cause_ = StopCause::kMemory;
  if (options_.interrupt != nullptr && options_.interrupt->load(std::memory_order_relaxed)) {
    stop_cause_ = StopCause::kInterrupted;
  }
  // After the other tests, so that a target reached by the last allowed evaluation counts as reached.
  if (has_best() && best().cost <= options_.target_cost) stop_cause_ = StopCause::kTarget;
  return stop_cause_ != StopCause::kNone;
}

bool Evaluator::StopRequested() const {
  return (options_.interrupt != nullptr && options_.interrupt->load(std::memory_order_relaxed)) ||
         seconds() >= options_.budget.max_seconds;
}

const EvaluationOutcome* Evaluator::Replayed(const Vector& x) const {
  return options_.replay.Find(evaluations(), x);
}

Evaluator::Outcome Evaluator::ReplayFailure(const Vector& x) {
  return RecordFailure(x, {options_.replay.FailureOf(evaluations())});
}

bool Evaluator::ReplayResiduals(const Vector& x, Vector& residuals, SparseJacobian* jacobian) const {
  const EvaluationOutcome* known = Replayed(x);
  if (known == nullptr || !std::isfinite(known->cost)) return false;
  const auto& kept = options_.replayed_residuals;
  const auto found = std::lower_bound(kept.begin(), kept.end(), evaluations(),
                                      [](const KeptResiduals& one, long at) { return one.evaluation < at; });
  if (found == kept.end() || found->evaluation != evaluations()) return false;
  const auto rows = static_cast<std::size_t>(fit_.residuals());
  std::size_t needed = rows;
  if (jacobian != nullptr) {
    for (const SparseJacobian::Piece& piece : jacobian->pieces)
      needed += static_cast<std::size_t>(piece.values.size());
  }
  if (found->numbers.size() != needed) return false;
  const double* next = found->numbers.data();
  residuals = Eigen::Map<const Vector>(next, static_cast<Eigen::Index>(rows));
  next += rows;
  if (jacobian == nullptr) return true;
  for (SparseJacobian::Piece& piece : jacobian->pieces) {
    std::copy_n(next, piece.values.size(), piece.values.data());
    next += piece.values.size();
  }
  return true;
}

void Evaluator::KeepResiduals(const Vector& residuals, const SparseJacobian* jacobian) {
  if (options_.most_kept == 0 || !keeps_residuals_) return;
  auto numbers = static_cast<std::size_t>(residuals.size());
  if (jacobian != nullptr) {
    for (const SparseJacobian::Piece& piece : jacobian->pieces)
      numbers += static_cast<std::size_t>(piece.values.size());
  }
  keeps_residuals_ = kept_numbers_ + numbers <= options_.most_kept;
  if (!keeps_residuals_) return;
  KeptResiduals kept{evaluations(), {}};
  kept.numbers.reserve(numbers);
  kept.numbers.assign(residuals.data(), residuals.data() + residuals.size());
  if (jacobian != nullptr) {
    for (const SparseJacobian::Piece& piece : jacobian->pieces)
      kept.numbers.insert(kept.numbers.end(), piece.values.data(), piece.values.data() + piece.values.size());
  }
  kept_numbers_ += numbers;
  const auto lock = LockRecord();
  kept_residuals_.push_back(std::move(kept));
}

std::optional<std::string> Evaluator::Violated(const Vector& x) const {
  if (fit_.constraints() == 0) return std::nullopt;
  Vector values;
  if (!fit_.Constraints(x, workspace_, values, nullptr)) return std::nullopt;
  const Vector sizes = fit_.ConstraintSizes(x);
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (values[i] > kConstraintTolerance * sizes[i]) return fit_.ConstraintName(static_cast<int>(i));
  }
  return std::nullopt;
}

void Evaluator::Record(const Vector& x, double cost, const std::string& failure) {
  const double now = seconds();
  const bool better = std::isfinite(cost) && (!has_best() || cost < best().cost);
  const bool is_best = better && !Violated(x);  // may need a prediction: not while the record is locked
  {
    const auto lock = LockRecord();
    record_.Add({now, cost, x, failure}, is_best);
  }
  if (options_.progress) options_.progress({evaluations(), now, has_best() ? best().cost : kInfinity}, *this);
}

Evaluator::Outcome Evaluator::RecordFailure(const Vector& x, const Error& error) {
  if (failures_++ == 0) first_failure_ = error.message;
  Record(x, kInfinity, error.message);
  return Outcome::kFailed;
}

Evaluator::Outcome Evaluator::Admit(const Vector& x, Infeasible infeasible) {
  if (MustStop()) return Outcome::kStop;
  const auto violated = Violated(x);
  if (!violated) return Outcome::kOk;
  ++infeasible_;
  if (infeasible == Infeasible::kEvaluate) return Outcome::kOk;
  return RecordFailure(x, {"constraint '" + *violated + "' is violated"});
}

Evaluator::Outcome Evaluator::Cost(const Vector& x, double& cost, Infeasible infeasible) {
  cost = kInfinity;
  const Outcome admitted = Admit(x, infeasible);
  if (admitted != Outcome::kOk) return admitted;
  if (const EvaluationOutcome* known = Replayed(x)) {
    cost = known->cost;
    if (!std::isfinite(cost)) return ReplayFailure(x);
    Record(x, cost);
    return Outcome::kOk;
  }
  const Result<double> result = fit_.Cost(x, workspace_);
  if (!result) return RecordFailure(x, result.error());
  cost = *result;
  Record(x, cost);
  return Outcome::kOk;
}

Evaluator::Outcome Evaluator::Residuals(const Vector& x, Vector& residuals, SparseJacobian* jacobian,
                                        Infeasible infeasible) {
  const Outcome admitted = Admit(x, infeasible);
  if (admitted != Outcome::kOk) return admitted;
  const EvaluationOutcome* known = Replayed(x);
  if (known != nullptr && !std::isfinite(known->cost)) return ReplayFailure(x);
  if (ReplayResiduals(x, residuals, jacobian)) {
    KeepResiduals(residuals, jacobian);
    Record(x, 0.5 * residuals.squaredNorm());
    return Outcome::kOk;
  }
  const Status status = fit_.Evaluate(x, workspace_, residuals, jacobian);
  if (!status) return RecordFailure(x, status.error());
  if (jacobian != nullptr) {
    for (const SparseJacobian::Piece& piece : jacobian->pieces) {
      if (!piece.values.allFinite()) return RecordFailure(x, {"a derivative is not finite"});
    }
  }
  KeepResiduals(residuals, jacobian);
  Record(x, 0.5 * residuals.squaredNorm());
  return Outcome::kOk;
}

Evaluator::Outcome Evaluator::Gradient(const Vector& x, double& cost, Vector& gradient,
                                       Infeasible infeasible) {
  cost = kInfinity;
  const Outcome outcome = Residuals(x, workspace_.residuals, &gradient_jacobian_, infeasible);
  if (outcome != Outcome::kOk) return outcome;
  cost = 0.5 * workspace_.residuals.squaredNorm();
  gradient.setZero(fit_.variables());
  for (const SparseJacobian::Piece& piece : gradient_jacobian_.pieces) {
    const auto rows = workspace_.residuals.segment(piece.first_row, piece.values.rows());
    for (std::size_t k = 0; k < piece.variables.size(); ++k) {
      gradient[piece.variables[k]] += piece.values.col(static_cast<Eigen::Index>(k)).dot(rows);
    }
  }
  return outcome;
}

void Evaluator::AbsorbFinished(const Evaluator& child, FinishedSearch search) {
  search.first = evaluations();
  search.evaluations = child.evaluations();
  search.failures = child.failures_;
  search.infeasible = child.infeasible_;
  search.first_failure = child.first_failure_;
  Absorb(child);
  const auto lock = LockRecord();
  finished_.push_back(std::move(search));
}

const FinishedSearch* Evaluator::FindFinished(const std::string& solver, const Vector& start,
                                              long max_evaluations) const {
  const auto same = [&](const FinishedSearch& search) {
    return search.solver == solver && search.max_evaluations == max_evaluations &&
           search.start.size() == start.size() && search.start == start &&
           search.first + search.evaluations <= options_.replay.recorded();
  };
  const auto found = std::find_if(options_.finished.begin(), options_.finished.end(), same);
  return found == options_.finished.end() ? nullptr : &*found;
}

void Evaluator::Restore(const Evaluator& parent, const FinishedSearch& search) {
  Restore(parent.options_.replay.Part(search.first, search.evaluations), search);
}

void Evaluator::Restore(const SearchRecord& all, const FinishedSearch& search) {
  Take(all);
  TakeCounts(search);
}

void Evaluator::TakeCounts(const FinishedSearch& search) {
  failures_ = search.failures;
  infeasible_ = search.infeasible;
  first_failure_ = search.first_failure;
}

void Evaluator::RestoreAll() {
  Take(options_.replay);
  const auto lock = LockRecord();
  finished_ = options_.finished;
}

void Evaluator::Take(const SearchRecord& more) {
  double lowest = has_best() ? best().cost : kInfinity;
  std::vector<bool> is_best;
  for (const TraceEntry& entry : more.trace()) {
    is_best.push_back(entry.cost < lowest && !Violated(entry.x));
    if (is_best.back()) lowest = entry.cost;
  }
  const auto lock = LockRecord();
  record_.Append(more, is_best);
}

void Evaluator::Absorb(const Evaluator& child) {
  Take(child.record_);
  failures_ += child.failures_;
  infeasible_ += child.infeasible_;
  if (first_failure_.empty()) first_failure_ = child.first_failure_;
  if (options_.progress) {
    options_.progress({evaluations(), seconds(), has_best() ? best().cost : kInfinity}, *this);
  }
}

}  // namespace sinew
