#include "identify/identification/identification.h"

#include <algorithm>
#include <utility>

#include "identify/check_problem.h"
#include "identify/error_concentration.h"
#include "identify/identification/odd_trials.h"
#include "identify/solvers/held_out_nuisance.h"
#include "identify/solvers/improved_start.h"
#include "identify/solvers/levenberg_marquardt.h"
#include "identify/solvers/marginal_cost.h"
#include "identify/solvers/prior_choice.h"
#include "identify/solvers/scheduled_starts.h"
#include "identify/solvers/trial_search.h"

namespace sinew {
namespace {

// A point that lowers the cost is taken for the answer, and the next look at intervals may find another.
constexpr int kMaxImprovements = 5;
constexpr double kNearlyGaussNewton = 1e-8;  // damping; a better point is close to a minimum

// What the data determine; a better point that is met on the way becomes the answer, and everything is done
// again from there, while the budget lasts.
Status AnalyseAndImprove(const LeastSquares& least_squares, UncertaintyOptions how,
                         const IdentificationOptions& options, Evaluator& evaluator, Identification& out) {
  const double found = out.result.cost;
  const double marginal = solvers::MarginalCost(least_squares, out.result.x);
  // Minima of curves are ranked by the search: a lower one that it met is not a better one.
  const bool has_curves = solvers::HasCurves(least_squares);
  bool is_last = false;
  for (int improvements = 0;; ++improvements) {
    // The last analysis has to find intervals, and may not meet yet another minimum.
    is_last = is_last || improvements == kMaxImprovements || !out.result.stop.converged();
    how.points = is_last || has_curves ? nullptr : &evaluator.trace();
    how.search_evaluations = evaluator.evaluations();
    SINEW_ASSIGN(out.uncertainty, AnalyseUncertainty(least_squares, out.result.x, how));
    const Vector& better = out.uncertainty.better_point;
    if (better.size() == 0 || is_last) break;
    const solvers::LevenbergMarquardt local(options.solver_options.cost_tolerance, kNearlyGaussNewton,
                                            has_curves);
    const SolverResult improved = local.Solve(evaluator, better);
    // A minimum of a lower cost may be so narrow that it is less probable.
    is_last = !(improved.cost < out.result.cost &&
                solvers::MarginalCost(least_squares, improved.x) <= marginal + solvers::kSameEvidence);
    if (is_last) continue;
    out.result.x = improved.x;
    out.result.cost = improved.cost;
    if (evaluator.MustStop()) out.result.stop = improved.stop;
  }
  if (out.result.cost < found)
    out.warnings.push_back({WarningKind::kBetterPointTaken, {}, {found, out.result.cost}, {}});
  return {};
}

bool HasPriors(const FitSetup& setup, const std::vector<std::pair<std::string, double>>& priors) {
  return std::all_of(priors.begin(), priors.end(), [&](const auto& prior) {
    const auto index = FindParameter(setup.parameters, prior.first);
    return index && setup.rest[*index] == prior.second;
  });
}

PriorSource SourceOf(const FigureOfMerit& figure, const solvers::PriorChoice& priors) {
  if (figure.parameter < 0) return PriorSource::kNone;
  if (priors.setup.IsHeld(figure.parameter)) return PriorSource::kHeld;
  const auto index = static_cast<std::size_t>(figure.parameter);
  if (priors.setup.parameters[index].other_starts.empty()) return PriorSource::kNone;
  if (priors.undetermined) return PriorSource::kUndetermined;
  return priors.any_chosen ? PriorSource::kChosen : PriorSource::kNone;
}

Warning FailuresOf(const Evaluator& search) {
  constexpr std::size_t kMostReasons = 5;
  Warning warning{WarningKind::kFailedEvaluations,
                  {},
                  {static_cast<double>(search.failures()), static_cast<double>(search.evaluations())},
                  search.first_failure()};
  for (const FailureReason& reason : search.record().reasons().MostFrequentFirst()) {
    if (warning.names.size() == kMostReasons) break;
    warning.names.push_back(reason.message);
    warning.numbers.push_back(static_cast<double>(reason.count));
  }
  return warning;
}

}  // namespace

Result<Identification> Identify(const Problem& problem, FitSetup setup, IdentificationOptions options) {
  if (options.solver.empty()) options.solver = problem.default_solver();
  SINEW_ASSIGN(const auto solver, MakeSolver(options.solver, options.solver_options));
  SINEW_TRY(CheckProblem(problem, setup));
  Identification out;
  out.solver = options.solver;
  out.solver_options = options.solver_options;
  options.evaluator.began = std::chrono::steady_clock::now();
  const solvers::PriorChoice priors = solvers::ChoosePriors(problem, setup, {options.evaluator.interrupt});
  out.setup = priors.setup;
  if (!HasPriors(out.setup, options.replayed_priors)) {
    options.evaluator.replay = {};
    options.evaluator.finished.clear();
    options.evaluator.replayed_residuals.clear();
  }

  const LeastSquares least_squares(problem, out.setup);
  const auto* interrupt = options.evaluator.interrupt;
  Evaluator evaluator(least_squares, std::move(options.evaluator));
  out.result = solver->Solve(evaluator, solvers::BestStart(evaluator));
  out.seconds = evaluator.seconds();
  if (options.after_search) options.after_search(out.result);
  if (out.result.stop.usable() && !out.setup.free.empty()) {
    UncertaintyOptions how;
    how.threads = options.solver_options.threads;
    how.interrupt = interrupt;
    how.profile = options.profiles && out.result.stop.kind != Termination::kMaxMemory;
    SINEW_TRY(AnalyseAndImprove(least_squares, how, options, evaluator, out));
    out.interval_seconds = evaluator.seconds() - out.seconds;
  }
  out.finished = evaluator.finished();
  out.kept_residuals = evaluator.kept_residuals();
  out.failures = evaluator.failures();
  const auto is_interrupted = [&] { return interrupt != nullptr && interrupt->load(); };
  out.interrupted = is_interrupted();
  if (!out.result.stop.usable()) {
    out.record = evaluator.TakeRecord();
    return out;
  }

  solvers::HeldOutSearch search;
  search.in_windows = true;
  search.threads = options.solver_options.threads;
  out.parameters =
      solvers::FitHeldOutNuisance(problem, least_squares.Parameters(out.result.x), out.setup.record, search);
  const auto unmeasured = problem.EstimateUnmeasured(out.parameters);
  if (unmeasured) out.parameters = unmeasured->parameters;
  if (out.failures > 0) {
    out.warnings.push_back(FailuresOf(evaluator));
  }
  if (!out.result.stop.converged())
    out.warnings.push_back({WarningKind::kNotConverged, {}, {}, out.result.stop.test});
  SINEW_ASSIGN(out.prediction, PredictAll(problem, out.parameters));
  if (unmeasured) {
    TakeOver(*unmeasured, out.prediction.values);
    out.unmeasured = Describe(problem.layout(), *unmeasured);
  }
  for (const Warning& note : out.uncertainty.notes) out.warnings.push_back(note);
  for (const Concentration& found : FindConcentrations(problem.layout(), out.prediction.values))
    out.warnings.push_back(ToWarning(found));
  if (out.result.stop.converged()) {
    for (const OddTrial& odd : FindOddTrials(problem, out.setup, out.parameters, interrupt))
      out.warnings.push_back(ToWarning(odd));
  }
  for (Warning& warning : problem.WarningsAt(out.parameters)) out.warnings.push_back(std::move(warning));
  out.pooled_fit = out.prediction.pooled;
  out.derived = DeriveResults(problem, out.setup, out.parameters, out.uncertainty);
  out.figures = problem.FiguresOfMerit(out.parameters, out.prediction.values);
  for (FigureOfMerit& figure : out.figures) figure.source = SourceOf(figure, priors);
  out.alternatives = CompareAlternatives(problem, out.parameters);
  out.interrupted = is_interrupted();
  out.record = evaluator.TakeRecord();
  return out;
}

}  // namespace sinew
