#include "identify/solvers/held_out_nuisance.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/constants.h"
#include "identify/fit_setup.h"
#include "identify/least_squares.h"
#include "identify/role_view.h"
#include "identify/solvers/improved_start.h"
#include "identify/solvers/local_fit.h"
#include "identify/solvers/window_search.h"

namespace sinew::solvers {
namespace {

constexpr long kEvaluations = 200;
// A model that leaves so little more of a trial than another one does has not ended at a minimum that is far
// worse: half of what a parameter more usually gains.
constexpr double kAsGood = 1;

// Of a trial, with the other answers themselves; -infinity without any.
double LowestCost(const Problem& problem, const FitSetup& setup, const std::vector<Vector>& answers) {
  double lowest = answers.empty() ? -kInfinity : kInfinity;
  for (const Vector& answer : answers) {
    FitSetup at = setup;
    at.rest = answer;
    const LeastSquares least_squares(problem, at);
    LeastSquares::Workspace workspace = least_squares.NewWorkspace();
    const auto cost = least_squares.Cost(least_squares.Start(), workspace);
    if (cost) lowest = std::min(lowest, *cost);
  }
  return lowest;
}

}  // namespace

Result<Vector> FitHeldOutNuisance(const Problem& problem, const Vector& parameters, FitRecord* record,
                                  const std::vector<Vector>& earlier) {
  std::set<std::string> held_out;
  for (const Block& block : problem.layout()) {
    if (block.role == BlockRole::kValidate) held_out.insert(block.trial);
  }
  Vector answer = parameters;
  for (const std::string& trial : held_out) {
    FitSetup setup;
    setup.parameters = problem.parameters();
    setup.rest = answer;
    setup.record = record;
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
    auto best = fit.Minimize(least_squares.Variables(answer), -1, {0, 1e-9}, kEvaluations);
    const auto try_from = [&](const Vector& start) {
      auto found = fit.Minimize(start, -1, {0, 1e-9}, kEvaluations);
      if (found.failure.empty() && (!best.failure.empty() || found.cost < best.cost)) best = std::move(found);
    };
    if (setup.HasNuisancePriors()) {
      for (const Vector& other : earlier) {
        Vector start = answer;
        for (const int index : setup.free) start[index] = other[index];
        try_from(least_squares.Variables(start));
      }
      if (best.failure.empty() && best.cost > LowestCost(alone, setup, earlier) + kAsGood) {
        FitSetup unrecorded = setup;  // hundreds of fits, of which one remains
        unrecorded.record = nullptr;
        LeastSquares in_windows(alone, unrecorded);
        try_from(SearchInWindows(in_windows, best.x, {}, {}).x);
      }
    } else {
      const auto improved =
          ImprovedStart(least_squares, best.failure.empty() ? least_squares.Parameters(best.x) : answer);
      if (improved) try_from(least_squares.Variables(*improved));
    }
    if (best.failure.empty()) answer = least_squares.Parameters(best.x);
  }
  return answer;
}

}  // namespace sinew::solvers
