// One identification from start to answer: solve, judge what the data determine, predict every trial.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "identify/alternative_prediction.h"
#include "identify/execution/evaluator.h"
#include "identify/fit_quality.h"
#include "identify/fit_setup.h"
#include "identify/identification/derived.h"
#include "identify/solvers/solver.h"
#include "identify/uncertainty/uncertainty.h"
#include "identify/unmeasured_estimate.h"
#include "identify/warning.h"

namespace sinew {

struct IdentificationOptions {
  std::string solver;  ///< empty: Problem::default_solver()
  SolverOptions solver_options;
  Evaluator::Options evaluator;
  /// The parameters of priors in the run that is resumed, by name. Where others are chosen now, because that
  /// run was stopped while it chose, its evaluations are of another fit, and are done again.
  std::vector<std::pair<std::string, double>> replayed_priors;
  bool profiles = true;  ///< false: intervals are linear
  /// Called once the search has ended, before the intervals; may be empty.
  std::function<void(const SolverResult&)> after_search;
};

/// What a step of a stepwise fit has found (identification/stepwise.h).
struct FinishedStep {
  std::string name;
  FitSetup setup;
  Uncertainty uncertainty;
  std::vector<FitQuality> pooled_fit;
  std::vector<DerivedResult> derived;
  std::size_t evaluations = 0;
  double seconds = 0;           ///< of solving
  double interval_seconds = 0;  ///< of finding what the data determine, better points included
};

struct Identification {
  std::string solver;
  SolverOptions solver_options;
  FitSetup setup;
  SolverResult result;
  SearchRecord record;
  std::vector<FinishedSearch> finished;       ///< of the search from many starts
  std::vector<KeptResiduals> kept_residuals;  ///< see Evaluator
  long failures = 0;
  bool interrupted = false;            ///< before the end: the search, or that the intervals were found
  double seconds = 0;                  ///< of solving
  double interval_seconds = 0;         ///< of finding what the data determine, better points included
  Vector parameters;                   ///< [P] at the answer
  Uncertainty uncertainty;             ///< empty if nothing was free or the answer is not usable
  FullPrediction prediction;           ///< empty if the answer is not usable
  std::vector<FitQuality> pooled_fit;  ///< per role and quantity, of what the fit, or the last step, compares
  std::vector<DerivedResult> derived;
  std::vector<AlternativeQuality> alternatives;  ///< errors of other predictions, see Problem::Alternatives
  std::vector<UnmeasuredChannel> unmeasured;     ///< of trials without a measurement, with their bands
  std::vector<FigureOfMerit> figures;            ///< empty if the answer is not usable
  std::vector<Warning> warnings;
  std::vector<FinishedStep> steps;  ///< the earlier steps of a stepwise fit
};

/// Errors: an unknown solver. A search that fails is no error: see Identification::result.stop.
Result<Identification> Identify(const Problem& problem, FitSetup setup, IdentificationOptions options);

}  // namespace sinew
