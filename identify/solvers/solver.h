// The interface of all solvers: a search over the box [0, 1]^n of a LeastSquares through an Evaluator, which
// ends with a named stop reason.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "identify/execution/evaluator.h"

namespace sinew {

/// Why a solver stopped. The value of the test that made it stop is in Stop::test.
enum class Termination {
  kCostChange,  ///< relative change of the cost below its tolerance; usable
  kGradient,    ///< projected gradient below its tolerance; usable
  kStepSize,    ///< step in the unit box below its tolerance; usable
  kAnnealed,    ///< annealing: last optima at successive temperatures agree within its tolerance; usable
  kStartsDone,  ///< multi-start: every start was searched; usable
  kTarget,      ///< the requested cost was reached; usable
  kStartsUnfinished,  ///< multi-start: the budget in equal shares was too small for all starts: some were
                      ///< left out, or ended at their share; best point so far, not converged
  kNothingFree,       ///< no parameter is free: the start was evaluated; usable
  kMaxEvaluations,    ///< budget; best point so far, not converged
  kMaxSeconds,        ///< budget; best point so far, not converged
  kMaxMemory,         ///< budget; best point so far, not converged
  kInterrupted,       ///< Ctrl-C; best point so far, not converged
  kSolverFailed,      ///< the solver failed (its message is in Stop::test); best point so far, not converged
  kInfeasible,        ///< no evaluated point satisfies the constraints; not usable
  kNoPrediction       ///< the problem could not be predicted at the start, or anywhere; not usable
};

/// snake_case name as in the JSON: "cost_change", "max_evaluations", ...
[[nodiscard]] const char* ToString(Termination termination);
/// The reverse; nothing if there is none of this name.
[[nodiscard]] std::optional<Termination> TerminationOf(const std::string& name);

struct Stop {
  Termination kind = Termination::kSolverFailed;
  std::string test;  ///< the test with its values: "relative cost change 2e-13 < 1e-10"

  /// True if the search ended by its own convergence test, not by a limit or a failure.
  [[nodiscard]] bool converged() const;
  /// True if there is a best point, converged or not.
  [[nodiscard]] bool usable() const {
    return kind != Termination::kNoPrediction && kind != Termination::kInfeasible;
  }
};

/// One start of a multi-start or one link of a chain, for the waterfall and the report.
struct Stage {
  std::string solver;
  Stop stop;
  long evaluations = 0;
  double cost = 0;
  Vector x;
};

struct SolverResult {
  Vector x;         ///< best point [n, in 0..1]; the start if there is none
  double cost = 0;  ///< at x; infinite if there is none
  Stop stop;
  int iterations = 0;
  /// Multi-start: every start, best first; chain: every link in order; else empty.
  std::vector<Stage> stages;
};

struct SolverOptions {
  std::uint64_t seed = 1;
  int threads = 1;
  /// Relative change of the cost at which local solvers stop.
  double cost_tolerance = 1e-12;
  /// Starts of a multi-start.
  int starts = 20;
};

/// How a search ended; the best point is in the evaluator.
struct Search {
  Stop stop;
  int iterations = 0;
  std::vector<Stage> stages;
  /// An evaluated point that is the answer although the evaluator's best is lower by less than matters; no x:
  /// that one is.
  TraceEntry answer = {};
};

/// Template method: Solve evaluates the start and handles the cases common to all solvers (no free parameter,
/// no prediction at the start); DoSolve searches.
class Solver {
 public:
  Solver() = default;
  virtual ~Solver() = default;
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;

  /// @param start [n, in 0..1]. The start is always evaluated and never lost: the result is at least as good.
  SolverResult Solve(Evaluator& evaluator, const Vector& start) const;

  /// True if the search can begin at a point without prediction: a global one continues elsewhere.
  [[nodiscard]] virtual bool ToleratesFailedStart() const { return false; }
  /// True if the search can begin at a point that violates a constraint.
  [[nodiscard]] virtual bool ToleratesInfeasibleStart() const { return ToleratesFailedStart(); }

 private:
  [[nodiscard]] bool CanBegin(const Evaluator& evaluator, const Vector& start) const;

  /// Searches from start, which has been evaluated. Every evaluation goes through the evaluator; on
  /// Outcome::kStop it returns at once, and Solve fills in the reason.
  virtual Search DoSolve(Evaluator& evaluator, const Vector& start) const = 0;
};

/// The Stop for a search that the evaluator ended. @pre evaluator.stop_cause() is not kNone.
[[nodiscard]] Stop StopFrom(const Evaluator& evaluator);

/// One line of `sinew list solvers`.
struct SolverEntry {
  std::string name;
  bool global = false;
  bool gradient = false;
  /// Handles Problem::constraints(). All others reject the points that violate one, and may stop early at a
  /// constraint.
  bool constraints = false;
  std::string description;  ///< with author and year
};

[[nodiscard]] const std::vector<SolverEntry>& SolverRegistry();

/// "sa", "ceres", "ipopt", "nlopt:LN_BOBYQA", "cmaes", "multistart", or a chain "sa+ceres". Errors: unknown
/// name, with a suggestion or the list.
Result<std::unique_ptr<Solver>> MakeSolver(const std::string& name, const SolverOptions& options);

}  // namespace sinew
