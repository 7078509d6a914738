// One identification from start to findings: solve, judge what the data can say, predict every trial.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "base/error.h"
#include "identify/execution/evaluator.h"
#include "identify/fit_quality.h"
#include "identify/fit_setup.h"
#include "identify/solvers/solver.h"
#include "identify/uncertainty/uncertainty.h"

namespace sinew {

struct IdentificationOptions {
  std::string solver = "ceres";
  SolverOptions solver_options;
  Evaluator::Options evaluator;
  bool profiles = true;  ///< false: intervals are linear
};

struct Identification {
  std::string solver;
  SolverOptions solver_options;
  FitSetup setup;
  SolverResult result;
  std::vector<TraceEntry> trace;
  long failures = 0;
  double seconds = 0;         ///< of solving
  Vector parameters;          ///< [P] at the answer
  Uncertainty uncertainty;    ///< empty if nothing was free or the answer is not usable
  FullPrediction prediction;  ///< empty if the answer is not usable
  std::vector<std::string> findings;
  std::vector<std::string> warnings;
};

/// Errors: an unknown solver. A search that fails is no error: see Identification::result.stop.
Result<Identification> Identify(const Problem& problem, FitSetup setup, IdentificationOptions options);

/// The findings in sentences: what was determined and what was not and why, how well training and validation
/// trials are predicted, and which bounds were hit.
[[nodiscard]] std::vector<std::string> DescribeFindings(const Problem& problem,
                                                        const Identification& identification);

}  // namespace sinew
