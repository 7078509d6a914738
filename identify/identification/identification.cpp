#include "identify/identification/identification.h"

#include <utility>

#include "identify/check_problem.h"
#include "identify/error_concentration.h"
#include "identify/solvers/held_out_nuisance.h"

namespace sinew {

Result<Identification> Identify(const Problem& problem, FitSetup setup, IdentificationOptions options) {
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
  out.result = solver->Solve(evaluator, least_squares.Start());
  out.seconds = evaluator.seconds();
  out.trace = evaluator.trace();
  out.failures = evaluator.failures();
  if (!out.result.stop.usable()) return out;

  SINEW_ASSIGN(out.parameters, FitHeldOutNuisance(problem, least_squares.Parameters(out.result.x)));
  if (out.failures > 0) {
    out.warnings.push_back(fmt::format("{} of {} evaluations failed and were rejected; the first because {}",
                                       out.failures, out.trace.size(), evaluator.first_failure()));
  }
  if (!out.result.stop.converged()) {
    out.warnings.push_back(fmt::format(
        "the search did not converge ({}): the answer is the best point so far", out.result.stop.test));
  }
  SINEW_ASSIGN(out.prediction, PredictAll(problem, out.parameters));
  if (!out.setup.free.empty()) {
    UncertaintyOptions how;
    how.threads = options.solver_options.threads;
    how.interrupt = interrupt;
    how.profile = options.profiles;
    SINEW_ASSIGN(out.uncertainty, AnalyseUncertainty(least_squares, out.result.x, how));
    for (const std::string& note : out.uncertainty.notes) out.warnings.push_back(note);
  }
  for (std::string& sentence :
       DescribeConcentrations(FindConcentrations(problem.layout(), out.prediction.values)))
    out.warnings.push_back(std::move(sentence));
  for (std::string& remark : problem.WarningsAt(out.parameters)) out.warnings.push_back(std::move(remark));
  out.findings = DescribeFindings(problem, out);
  return out;
}

}  // namespace sinew
