// Comparison of solvers on one problem: runs of every solver from the same starts.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "identify/execution/evaluator.h"
#include "identify/execution/shared_loop.h"
#include "identify/solvers/solver.h"

namespace sinew {

/// The run of one solver from one start.
struct StudyRun {
  std::string solver;
  std::uint64_t seed = 0;
  Stop stop;
  double cost = 0;
  double seconds = 0;
  long evaluations = 0;
  /// An evaluation whose cost was lower than that of all before it.
  struct Improvement {
    long evaluation;  ///< its number, from 1
    double cost;
    double seconds;
  };
  std::vector<Improvement> improvements;
  Vector start;       ///< in the unit box
  Vector parameters;  ///< all of the problem; empty if there is no usable answer

  struct Effort {
    double evaluations;
    double seconds;
  };
  /// Evaluations and seconds until the cost first reached the target; NaN if it never did.
  [[nodiscard]] Effort ToTarget(double target) const;
};

struct StudyOptions {
  std::vector<std::string> solvers;  ///< names as MakeSolver takes them
  int repeats = 5;                   ///< runs of each solver [>= 1]
  SolverOptions solver_options;      ///< the seed is that of the first repeat; each further one adds 1
  /// Of each run. Without any limit, 20,000 evaluations: a global solver need not end by itself.
  std::optional<Budget> budget;
  std::optional<double> target;  ///< cost that counts as success; default: within 1 % of the best of all runs
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(int done, int all)> progress;
  std::vector<StudyRun> done;  ///< of a comparison that is resumed: these are not done again
  std::function<void(const StudyRun&)> after_run;  ///< called after each new run that was not interrupted
  /// Each run is done by one process. One after the other in each of them, because their times are compared.
  SharedWork work;
};

struct Study {
  bool finished = true;   ///< false: it was interrupted, and these are the runs that had ended
  std::vector<int> free;  ///< indices of the parameters that were fitted
  std::vector<StudyRun> runs;
  double best = std::numeric_limits<double>::infinity();  ///< cost; infinite if no run has a usable answer
  double target = 0;
};

/// Runs the comparison. The first repeat starts at the problem's start values, each further one at a random
/// point of the box, the same for every solver. If interrupted, the result contains the runs that had ended.
/// Errors: a solver that does not exist, or is named twice.
Result<Study> CompareSolvers(const LeastSquares& problem, const StudyOptions& options);

/// All runs of one solver. Medians are over the runs for which the number exists; NaN if there is none.
struct SolverSummary {
  std::string solver;
  int repeats = 0;
  int successes = 0;
  double cost_median = 0;
  double cost_worst = 0;
  double evaluations = 0;            ///< median
  double evaluations_to_target = 0;  ///< median
  double seconds = 0;                ///< median
  double seconds_to_target = 0;      ///< median
  std::vector<double> mean;          ///< of each free parameter
  std::vector<double> deviation;     ///< of each free parameter: standard deviation over the repeats
};

/// One summary per solver that ran, in the order in which they first ran.
[[nodiscard]] std::vector<SolverSummary> Summarise(const Study& study);

}  // namespace sinew
