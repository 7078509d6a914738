// All evaluations of a solver go through an Evaluator: it counts them, enforces the budget, records the
// trace, keeps the best point, and replays the recorded evaluations of an interrupted run.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <limits>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "identify/execution/finished_search.h"
#include "identify/execution/search_record.h"
#include "identify/least_squares.h"

namespace sinew {

inline constexpr long kUnlimitedEvaluations = std::numeric_limits<long>::max();

struct Budget {
  long max_evaluations = kUnlimitedEvaluations;
  double max_seconds = std::numeric_limits<double>::infinity();
  /// [bytes] of the whole process, as they are in the machine's memory (ResidentMemory)
  double max_memory = std::numeric_limits<double>::infinity();
};

/// State of a running search, for a progress display.
struct Progress {
  long evaluations = 0;
  double seconds = 0;
  double best_cost = std::numeric_limits<double>::infinity();
};

/// Residuals and derivatives of one evaluation, as they are kept for a search that is resumed.
struct KeptResiduals {
  long evaluation = 0;          ///< index in the record
  std::vector<double> numbers;  ///< the residuals, then the pieces of the Jacobian, if it was asked for
};

class Evaluator;

/// Lets another thread read the record of a search while it runs: to save it before the process is ended.
struct EvaluatorWatch {
  std::mutex mutex;                    ///< held while the record changes
  const Evaluator* running = nullptr;  ///< under the mutex; its record and counts may be read
};

/// Evaluations of one search, with their record.
///
/// A solver calls Cost, Residuals or Gradient, each of which is one evaluation, and reacts to the Outcome:
/// kOk, use the values; kFailed, treat the point as rejected; kStop, return at once. It does not check
/// budgets, interrupts or the target itself, and it need not remember its best point. Failed and rejected
/// points count as evaluations, with an infinite cost in the trace.
///
/// Resuming: with Options::replay, evaluation i is answered from outcome i of that record if its point is the
/// recorded one; a deterministic solver thus repeats its search without predictions. Residuals and
/// derivatives are recorded as far as Options::most_kept allows, and computed again beyond. A point that
/// differs from the record is predicted, so that a record of another search does no harm.
///
/// Not thread-safe. Parallel searches have one Evaluator each, and Absorb merges their records into the
/// parent's in a fixed order, so that the trace does not depend on the number of threads.
class Evaluator {
 public:
  enum class Outcome {
    kOk,
    kFailed,  ///< no prediction at this point, or it violates a constraint: reject it and continue
    kStop     ///< budget used, interrupted or target reached: return at once; stop_cause() says which
  };

  struct Options {
    Budget budget;
    double target_cost = -std::numeric_limits<double>::infinity();  ///< stop when the cost is at or below it
    const std::atomic<bool>* interrupt = nullptr;                   ///< set to true by Ctrl-C; may be null
    std::function<void(const Progress&, const Evaluator&)> progress;  ///< called at every evaluation
    EvaluatorWatch* watch = nullptr;                                  ///< of this search; may be null
    /// Of the run that is resumed: their evaluations are those of `replay` from `first` on.
    std::vector<FinishedSearch> finished;
    SearchRecord replay;                            ///< of the run that is resumed
    std::vector<KeptResiduals> replayed_residuals;  ///< of some of these, in their order
    /// Numbers of residuals and derivatives that are kept for a search that is resumed; 0: none.
    std::size_t most_kept = 0;
    long most_entries = 0;  ///< of the trace, see SearchRecord
    std::chrono::steady_clock::time_point began = std::chrono::steady_clock::now();
  };

  Evaluator(const LeastSquares& fit, Options options);
  ~Evaluator();
  Evaluator(const Evaluator&) = delete;
  Evaluator& operator=(const Evaluator&) = delete;

  /// Treatment of a point that violates a constraint of the problem. Such a point never becomes best().
  enum class Infeasible {
    kReject,   ///< kFailed without a prediction: for algorithms without constraints
    kEvaluate  ///< evaluated like any other: for algorithms that handle constraints themselves
  };

  /// Cost at x; one evaluation.
  /// @param x [n, in 0..1; values outside are clamped] @param cost infinite unless the outcome is kOk
  Outcome Cost(const Vector& x, double& cost, Infeasible infeasible = Infeasible::kReject);
  /// Residuals and, if jacobian is not null, the Jacobian at x; one evaluation. Fails also if a derivative is
  /// not finite.
  /// @param residuals, jacobian as in LeastSquares::Evaluate; set if the outcome is kOk
  Outcome Residuals(const Vector& x, Vector& residuals, SparseJacobian* jacobian,
                    Infeasible infeasible = Infeasible::kReject);
  /// Cost and gradient J'r [n] at x; one evaluation.
  Outcome Gradient(const Vector& x, double& cost, Vector& gradient,
                   Infeasible infeasible = Infeasible::kReject);

  /// True if no further evaluation is allowed; stop_cause() then gives the reason.
  bool MustStop();
  /// True if the search was interrupted or its time is over. Unlike MustStop it may be asked in any thread,
  /// by work beside the evaluations.
  [[nodiscard]] bool StopRequested() const;
  /// Name of the first constraint that x violates by more than rounding. Empty also where a constraint cannot
  /// be evaluated because there is no prediction: such a point is rejected for that reason.
  [[nodiscard]] std::optional<std::string> Violated(const Vector& x) const;

  [[nodiscard]] const LeastSquares& fit() const { return fit_; }
  [[nodiscard]] long evaluations() const { return record_.evaluations(); }
  [[nodiscard]] long failures() const { return failures_; }
  [[nodiscard]] const std::string& first_failure() const { return first_failure_; }
  /// Number of points, evaluated or rejected, that violate a constraint.
  [[nodiscard]] long infeasible() const { return infeasible_; }
  [[nodiscard]] bool has_best() const { return record_.has_best(); }
  /// Best evaluated point that satisfies the constraints; @pre has_best().
  [[nodiscard]] const TraceEntry& best() const { return record_.best(); }
  [[nodiscard]] const SearchRecord& record() const { return record_; }
  /// Leaves an empty one, which is watched no longer: a record may be large.
  [[nodiscard]] SearchRecord TakeRecord();
  [[nodiscard]] const std::vector<TraceEntry>& trace() const { return record_.trace(); }
  /// Of the first evaluations with residuals or derivatives, as many as Options::most_kept allows.
  [[nodiscard]] const std::vector<KeptResiduals>& kept_residuals() const { return kept_residuals_; }
  [[nodiscard]] const Options& options() const { return options_; }
  [[nodiscard]] double seconds() const;
  /// The remaining budget, that of the share if one is set.
  [[nodiscard]] Budget remaining() const;

  /// Allows at most this many further evaluations until EndShare, so that one solver of a chain leaves a part
  /// of the budget to the next.
  void BeginShare(long evaluations);
  void EndShare();

  /// Why Outcome::kStop was returned; kNone if it was not.
  enum class StopCause { kNone, kEvaluations, kSeconds, kMemory, kInterrupted, kTarget };
  [[nodiscard]] StopCause stop_cause() const { return stop_cause_; }

  /// Appends the evaluations of a child (one start of a multi-start) to this record, updates the best point
  /// and the counts. The order of the calls is the order of the trace.
  void Absorb(const Evaluator& child);
  /// The same, of a search that came to its end by itself. @param search all but `first`, which is set here
  void AbsorbFinished(const Evaluator& child, FinishedSearch search);
  /// All that were absorbed so, in that order.
  [[nodiscard]] const std::vector<FinishedSearch>& finished() const { return finished_; }

  /// The search of Options::finished that was asked the same, or nullptr.
  [[nodiscard]] const FinishedSearch* FindFinished(const std::string& solver, const Vector& start,
                                                   long max_evaluations) const;
  /// Takes the evaluations of such a search over, of the parent that is resumed. @pre nothing was evaluated
  void Restore(const Evaluator& parent, const FinishedSearch& search);
  /// The same, of a search of another process.
  void Restore(const SearchRecord& all, const FinishedSearch& search);
  /// Takes over everything that the run which is resumed has evaluated. @pre nothing was evaluated
  void RestoreAll();

 private:
  [[nodiscard]] long evaluation_limit() const;
  /// kOk if the point may be predicted now; else the outcome to return.
  Outcome Admit(const Vector& x, Infeasible infeasible);
  /// The outcome of this evaluation if the run is resumed and its recorded point is x, else nullptr.
  const EvaluationOutcome* Replayed(const Vector& x) const;
  /// @pre the outcome of this evaluation was replayed, and is a failure
  Outcome ReplayFailure(const Vector& x);
  /// Residuals and derivatives from that record. @return false: they are not in it
  bool ReplayResiduals(const Vector& x, Vector& residuals, SparseJacobian* jacobian) const;
  void KeepResiduals(const Vector& residuals, const SparseJacobian* jacobian);
  void Take(const SearchRecord& more);
  void TakeCounts(const FinishedSearch& search);
  bool NeedsMuchMemory();
  [[nodiscard]] std::unique_lock<std::mutex> LockRecord() const;
  void Record(const Vector& x, double cost, const std::string& failure = {});
  Outcome RecordFailure(const Vector& x, const Error& error);

  const LeastSquares& fit_;
  Options options_;
  mutable LeastSquares::Workspace workspace_;  // scratch
  SparseJacobian gradient_jacobian_;
  SearchRecord record_;
  std::vector<FinishedSearch> finished_;
  std::vector<KeptResiduals> kept_residuals_;
  std::size_t kept_numbers_ = 0;
  bool keeps_residuals_ = true;  // until the first that finds no room: a search is repeated from its start
  long failures_ = 0;
  long infeasible_ = 0;
  long share_end_ = std::numeric_limits<long>::max();
  double next_look_at_memory_ = 0;  // [s]
  std::string first_failure_;
  StopCause stop_cause_ = StopCause::kNone;
};

}  // namespace sinew
