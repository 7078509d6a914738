#include "identify/uncertainty/linearization.h"

#include <algorithm>
#include <cmath>

#include "identify/uncertainty/verdict.h"

namespace sinew::uncertainty {
namespace {

/// Largest change of a block, as a share of its signal, that the whole range of a variable makes by `change`.
bool ChangesAnything(const Linearization& at, const Vector& change) {
  return std::any_of(at.blocks.begin(), at.blocks.end(), [&](const Linearization::Rows& rows) {
    const double scale = rows.signal * std::sqrt(static_cast<double>(rows.count));
    return change.segment(rows.first, rows.count).norm() > kNoChange * scale;
  });
}

VariableStatus StatusOf(const Linearization& at, int variable) {
  const double x = at.x[variable];
  const double gradient = at.gradient[variable];
  if (!ChangesAnything(at, at.jacobian.col(variable))) return VariableStatus::kNoDependence;
  if (x <= kBoundTolerance && gradient > 0) return VariableStatus::kAtLower;
  if (x >= 1 - kBoundTolerance && gradient < 0) return VariableStatus::kAtUpper;
  return VariableStatus::kInside;
}

}  // namespace

Result<Linearization> Linearize(const LeastSquares& problem, const Vector& x) {
  Linearization at;
  at.x = x;
  at.parameters = problem.Parameters(x);
  at.slopes = problem.Slopes(x);

  LeastSquares::Workspace workspace = problem.NewWorkspace();
  SparseJacobian jacobian = problem.NewJacobian();
  SINEW_TRY(problem.Evaluate(x, workspace, at.residuals, &jacobian));
  at.jacobian = jacobian.Dense(problem.residuals(), problem.variables());
  if (!at.jacobian.allFinite()) return Fail("a derivative at the solution is not finite");
  at.gradient = at.jacobian.transpose() * at.residuals;
  at.cost = 0.5 * at.residuals.squaredNorm();

  const Layout& layout = problem.problem().layout();
  for (const LeastSquares::TrainBlock& train : problem.train_blocks()) {
    const Block& block = layout[static_cast<std::size_t>(train.block)];
    double sum = 0;
    for (int i = 0; i < block.samples(); ++i) {
      const double value =
          at.residuals[train.first_row + i] +
          block.WeightOf(static_cast<std::size_t>(i)) * block.measured[static_cast<std::size_t>(i)];
      sum += value * value;
    }
    at.blocks.push_back({train.block, train.first_row, block.samples(), std::sqrt(sum / block.samples())});
    at.data_rows += block.samples();
  }
  at.prior_variable = problem.PriorVariables();
  for (int v = 0; v < problem.variables(); ++v) {
    at.status.push_back(StatusOf(at, v));
    (at.parameter(problem, v).kind == ParameterKind::kNuisance ? at.nuisance : at.reported).push_back(v);
  }
  return at;
}

std::vector<std::string> FittedChannels(const LeastSquares& problem) {
  std::vector<std::string> names;
  for (const LeastSquares::TrainBlock& train : problem.train_blocks()) {
    const std::string& name = problem.problem().layout()[static_cast<std::size_t>(train.block)].channel;
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

bool IsWithoutEffectEverywhere(const LeastSquares& problem, const Linearization& at, int variable) {
  LeastSquares::Workspace workspace = problem.NewWorkspace();
  Vector residuals;
  Vector x = at.x;
  for (const double value : {0.0, 0.1, 0.5, 0.9, 1.0}) {
    x[variable] = value;
    if (!problem.Evaluate(x, workspace, residuals, nullptr)) continue;
    if (ChangesAnything(at, residuals - at.residuals)) return false;
  }
  return true;
}

}  // namespace sinew::uncertainty
