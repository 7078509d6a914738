#include "identify/files/recorded_cost.h"

#include <algorithm>
#include <cmath>

#include "base/constants.h"

namespace sinew::files {
namespace {

// The same program gives the same bits. Other processors round the elementary functions otherwise, which an
// integrator enlarges.
constexpr double kSameCost = 1e-6;

bool IsSame(double a, double b) {
  return std::abs(a - b) <= kSameCost * std::max(std::abs(a), std::abs(b));
}

// The fit whose start is the answer of the run; nothing if it is not of this problem's parameters.
std::optional<FitSetup> SetupOf(const RecordedRun& run, const Problem& problem) {
  FitSetup setup;
  setup.parameters = problem.parameters();
  setup.rest = Vector::Constant(static_cast<Eigen::Index>(setup.parameters.size()), kNaN);
  for (const auto& [name, value] : run.values) {
    const auto found = FindParameter(setup.parameters, name);
    if (!found && run.at_null.count(name) > 0) continue;
    if (!found) return std::nullopt;
    const Parameter& p = setup.parameters[static_cast<std::size_t>(*found)];
    if (!(value >= p.lower && value <= p.upper)) return std::nullopt;
    setup.rest[*found] = value;
  }
  for (std::size_t i = 0; i < setup.parameters.size(); ++i) {
    const Parameter& p = setup.parameters[i];
    double& value = setup.rest[static_cast<Eigen::Index>(i)];
    if (std::isnan(value) && p.kind != ParameterKind::kEffect) return std::nullopt;
    if (std::isnan(value)) value = p.null_value;
    const bool is_free = std::find(run.variables.begin(), run.variables.end(), p.name) != run.variables.end();
    if (is_free) setup.free.push_back(static_cast<int>(i));
  }
  return setup.free.size() == run.variables.size() ? std::optional(setup) : std::nullopt;
}

}  // namespace

Status CheckBestCost(const std::string& path, const RecordedRun& run, const LeastSquares& fit) {
  const auto best =
      std::min_element(run.record.trace().begin(), run.record.trace().end(),
                       [](const TraceEntry& a, const TraceEntry& b) { return a.cost < b.cost; });
  if (best == run.record.trace().end() || !std::isfinite(best->cost)) return {};
  auto workspace = fit.NewWorkspace();
  const Result<double> cost = fit.Cost(best->x, workspace);
  if (!cost)
    return Fail("--resume: {} has a best point that cannot be evaluated: {}", path, cost.error().message);
  if (IsSame(*cost, best->cost)) return {};
  return Fail(
      "--resume: {} states the cost {} for its best point, which has the cost {}: it was changed, or made by "
      "another build of this program",
      path, best->cost, *cost);
}

std::vector<Warning> WarningsOfRun(const std::string& path, const RecordedRun& run, const Problem& problem,
                                   const std::string& data_hash) {
  std::vector<Warning> warnings;
  if (!run.finished) warnings.push_back({WarningKind::kUnfinishedStart, {path}, {}, {}});
  if (run.problem.empty() || run.data_hash != data_hash || run.steps > 0 || !std::isfinite(run.cost))
    return warnings;
  const auto setup = SetupOf(run, problem);
  if (!setup) return warnings;
  const LeastSquares fit(problem, *setup);
  auto workspace = fit.NewWorkspace();
  const Result<double> cost = fit.Cost(fit.Start(), workspace);
  const double evaluated = cost ? *cost : kInfinity;
  if (!IsSame(evaluated, run.cost))
    warnings.push_back({WarningKind::kStatedCost, {path}, {run.cost, evaluated}, {}});
  return warnings;
}

}  // namespace sinew::files
