#include "identify/identification/identification.h"

#include <utility>

#include "identify/check_problem.h"
#include "identify/error_concentration.h"
#include "identify/solvers/held_out_nuisance.h"
#include "identify/solvers/improved_start.h"

namespace sinew {

Result<Identification> Identify(const Problem& problem, FitSetup setup, IdentificationOptions options) {
  if (options.solver.empty()) options.solver = problem.default_solver();
  SINEW_ASSIGN(const auto solver, MakeSolver(options.solver, options.solver_options));
  SINEW_TRY(CheckProblem(problem, setup));
  Identification out;
  out.solver = options.solver;
  out.solver_options = options.solver_options;
  out.setup = std::move(setup);

  const LeastSquares least_squares(problem, out.setup);
  options.evaluator.began = std::chrono::steady_clock::now();
  const auto* interrupt = options.evaluator.interrupt;
  Evaluator evaluator(least_squares, std::move(options.evaluator));
  out.result = solver->Solve(evaluator, solvers::BestStart(least_squares));
  out.seconds = evaluator.seconds();
  out.trace = evaluator.trace();
  out.failures = evaluator.failures();
  if (!out.result.stop.usable()) return out;

  SINEW_ASSIGN(out.parameters, solvers::FitHeldOutNuisance(problem, least_squares.Parameters(out.result.x)));
  if (out.failures > 0) {
    out.warnings.push_back({WarningKind::kFailedEvaluations,
                            {},
                            {static_cast<double>(out.failures), static_cast<double>(out.trace.size())},
                            evaluator.first_failure()});
  }
  if (!out.result.stop.converged())
    out.warnings.push_back({WarningKind::kNotConverged, {}, {}, out.result.stop.test});
  SINEW_ASSIGN(out.prediction, PredictAll(problem, out.parameters));
  if (!out.setup.free.empty()) {
    UncertaintyOptions how;
    how.threads = options.solver_options.threads;
    how.interrupt = interrupt;
    how.profile = options.profiles;
    SINEW_ASSIGN(out.uncertainty, AnalyseUncertainty(least_squares, out.result.x, how));
    for (const Warning& note : out.uncertainty.notes) out.warnings.push_back(note);
  }
  for (const Concentration& found : FindConcentrations(problem.layout(), out.prediction.values))
    out.warnings.push_back(ToWarning(found));
  for (Warning& warning : problem.WarningsAt(out.parameters)) out.warnings.push_back(std::move(warning));
  out.pooled_fit = out.prediction.pooled;
  return out;
}

}  // namespace sinew
