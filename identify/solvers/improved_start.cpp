#include "identify/solvers/improved_start.h"

#include <algorithm>
#include <vector>

namespace sinew::solvers {

std::optional<Vector> ImprovedStart(const LeastSquares& fit, const Vector& parameters) {
  const Problem& problem = fit.problem();
  std::vector<bool> compared;
  for (const Block& block : problem.layout()) compared.push_back(block.role == BlockRole::kTrain);
  auto improved = problem.ImprovedStart(fit.setup().free, compared, parameters);
  if (!improved) return {};
  for (const int index : fit.setup().free) {
    const Parameter& p = fit.setup().parameters[static_cast<std::size_t>(index)];
    (*improved)[index] = std::clamp((*improved)[index], p.lower, p.upper);
  }
  return improved;
}

Vector BestStart(const LeastSquares& fit) {
  Vector start = fit.Start();
  const auto improved = ImprovedStart(fit, fit.Parameters(start));
  if (!improved) return start;
  auto workspace = fit.NewWorkspace();
  Vector second = fit.Variables(*improved);
  const auto here = fit.Cost(start, workspace);
  const auto there = fit.Cost(second, workspace);
  return there && (!here || *there < *here) ? second : start;
}

}  // namespace sinew::solvers
