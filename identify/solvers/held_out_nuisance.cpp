#include "identify/solvers/held_out_nuisance.h"

#include <set>
#include <string>

#include "identify/fit_setup.h"
#include "identify/least_squares.h"
#include "identify/role_view.h"
#include "identify/solvers/improved_start.h"
#include "identify/solvers/local_fit.h"

namespace sinew::solvers {
namespace {

constexpr long kEvaluations = 200;

}  // namespace

Result<Vector> FitHeldOutNuisance(const Problem& problem, const Vector& parameters) {
  std::set<std::string> held_out;
  for (const Block& block : problem.layout()) {
    if (block.role == BlockRole::kValidate) held_out.insert(block.trial);
  }
  Vector answer = parameters;
  for (const std::string& trial : held_out) {
    FitSetup setup;
    setup.parameters = problem.parameters();
    setup.rest = answer;
    for (std::size_t i = 0; i < setup.parameters.size(); ++i) {
      const Parameter& p = setup.parameters[i];
      if (p.kind == ParameterKind::kNuisance && p.trial == trial) setup.free.push_back(static_cast<int>(i));
    }
    if (setup.free.empty()) continue;
    const RoleView alone(problem, [&](const Block& block) {
      const bool fitted = block.trial == trial && block.role == BlockRole::kValidate;
      return fitted ? BlockRole::kTrain : BlockRole::kPredicted;
    });
    const LeastSquares least_squares(alone, setup);
    LocalFit fit(least_squares);
    const auto outcome = fit.Minimize(least_squares.Variables(answer), -1, {0, 1e-9}, kEvaluations);
    if (outcome.failure.empty()) answer = least_squares.Parameters(outcome.x);
    const auto improved = ImprovedStart(least_squares, answer);
    if (!improved) continue;
    const auto second = fit.Minimize(least_squares.Variables(*improved), -1, {0, 1e-9}, kEvaluations);
    if (second.failure.empty() && (!outcome.failure.empty() || second.cost < outcome.cost))
      answer = least_squares.Parameters(second.x);
  }
  return answer;
}

}  // namespace sinew::solvers
