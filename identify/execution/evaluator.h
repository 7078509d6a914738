// The gate through which every evaluation of a solver passes: it counts, keeps the budget, records the trace,
// remembers the best point, and answers from the record of an interrupted run.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "identify/least_squares.h"

namespace sinew {

struct Budget {
  long max_evaluations = std::numeric_limits<long>::max();
  double max_seconds = std::numeric_limits<double>::infinity();
};

/// One evaluation as it is kept in the run file.
struct TraceEntry {
  double seconds = 0;  ///< since the start of the run
  double cost = 0;     ///< infinite if the simulation failed there
  Vector x;
};

/// What a person watches while it runs.
struct Progress {
  long evaluations = 0;
  double seconds = 0;
  double best_cost = std::numeric_limits<double>::infinity();
};

/// Not thread-safe: one per thread of search. A multi-start gives each of its starts an evaluator of its own.
class Evaluator {
 public:
  enum class Outcome {
    kOk,
    kFailed,  ///< no prediction at this point: reject it and go on
    kStop     ///< budget used up, interrupted or target reached: return at once with best()
  };

  struct Options {
    Budget budget;
    double target_cost = -std::numeric_limits<double>::infinity();  ///< stop when the cost is at or below it
    const std::atomic<bool>* interrupt = nullptr;                   ///< set by Ctrl-C
    std::function<void(const Progress&, const Evaluator&)> progress;  ///< called at every evaluation
    std::vector<TraceEntry> replay;  ///< evaluations of the run that is resumed
    std::chrono::steady_clock::time_point began = std::chrono::steady_clock::now();
  };

  Evaluator(const LeastSquares& fit, Options options);

  /// What becomes of a point that violates a constraint of the problem. It is never best().
  enum class Infeasible {
    kReject,   ///< kFailed without a prediction: for searches that know nothing of constraints
    kEvaluate  ///< for searches that find their way back by themselves
  };

  /// Cost at x [n, in 0..1]; one evaluation.
  Outcome Cost(const Vector& x, double& cost, Infeasible infeasible = Infeasible::kReject);
  /// Residuals and, if jacobian is not null, the Jacobian at x; one evaluation.
  Outcome Residuals(const Vector& x, Vector& residuals, SparseJacobian* jacobian,
                    Infeasible infeasible = Infeasible::kReject);
  /// Cost and gradient J' r at x; one evaluation.
  Outcome Gradient(const Vector& x, double& cost, Vector& gradient,
                   Infeasible infeasible = Infeasible::kReject);

  /// True if no further evaluation is allowed; stop_cause() then says why.
  bool MustStop();
  /// Name of the first constraint that x violates by more than rounding. None where there is no prediction:
  /// the point is rejected for that.
  [[nodiscard]] std::optional<std::string> Violated(const Vector& x) const;

  [[nodiscard]] const LeastSquares& fit() const { return fit_; }
  [[nodiscard]] long evaluations() const { return static_cast<long>(trace_.size()); }
  [[nodiscard]] long failures() const { return failures_; }
  [[nodiscard]] const std::string& first_failure() const { return first_failure_; }
  /// Points, evaluated or rejected, that violate a constraint.
  [[nodiscard]] long infeasible() const { return infeasible_; }
  [[nodiscard]] bool has_best() const { return best_ >= 0; }
  /// Best evaluated point that satisfies the constraints; @pre has_best().
  [[nodiscard]] const TraceEntry& best() const { return trace_[static_cast<std::size_t>(best_)]; }
  [[nodiscard]] const std::vector<TraceEntry>& trace() const { return trace_; }
  [[nodiscard]] const Options& options() const { return options_; }
  [[nodiscard]] double seconds() const;
  /// Budget that is left, of the share if one is set.
  [[nodiscard]] Budget remaining() const;

  /// Until EndShare, at most that many further evaluations: one link of a chain leaves something to the next.
  void BeginShare(long evaluations);
  void EndShare();

  /// Why Outcome::kStop was returned; empty if it was not.
  enum class StopCause { kNone, kEvaluations, kSeconds, kInterrupted, kTarget };
  [[nodiscard]] StopCause stop_cause() const { return stop_cause_; }

  /// Takes over the evaluations of a child (a start of a multi-start), in the order in which this is called.
  void Absorb(const Evaluator& child);

 private:
  [[nodiscard]] long evaluation_limit() const;
  /// Outcome::kOk if the point may be predicted now.
  Outcome Admit(const Vector& x, Infeasible infeasible);
  /// The recorded cost if this evaluation is one of the run that is resumed.
  const TraceEntry* Replayed(const Vector& x) const;
  void Keep(TraceEntry entry);
  void Record(const Vector& x, double cost);
  Outcome RecordFailure(const Vector& x, const Error& error);

  const LeastSquares& fit_;
  Options options_;
  mutable LeastSquares::Workspace workspace_;  // scratch
  SparseJacobian gradient_jacobian_;
  std::vector<TraceEntry> trace_;
  long best_ = -1;
  long failures_ = 0;
  long infeasible_ = 0;
  long share_end_ = std::numeric_limits<long>::max();
  std::string first_failure_;
  StopCause stop_cause_ = StopCause::kNone;
};

}  // namespace sinew
