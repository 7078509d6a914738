#include "identify/solvers/marginal_cost.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/constants.h"
#include "base/symmetric_solver.h"
#include "identify/solvers/box_quadratic_model.h"

namespace sinew::solvers {

namespace {

// Variables that are integrated out.
std::vector<int> NuisanceVariables(const LeastSquares& fit) {
  std::vector<int> nuisance;
  for (const int variable : fit.PriorVariables()) {
    const int index = fit.setup().free[static_cast<std::size_t>(variable)];
    if (fit.setup().parameters[static_cast<std::size_t>(index)].kind == ParameterKind::kNuisance)
      nuisance.push_back(variable);
  }
  return nuisance;
}

// ln det H / 2, infinite if H is not positive definite.
double HalfLogDeterminant(const BoxQuadraticModel& model, const std::vector<int>& nuisance) {
  const Vector unit = Vector::Ones(static_cast<Eigen::Index>(nuisance.size()));
  const SymmetricSolver solver(SymmetricView(model.normal, nuisance, unit, 0));
  return solver.positive_definite() ? 0.5 * solver.LogDeterminant() : kInfinity;
}

// The setup without bounds of the nuisance values that have priors.
FitSetup Unbounded(const FitSetup& setup) {
  constexpr double kFar = 1e6;  // standard deviations
  FitSetup wide = setup;
  for (Parameter& p : wide.parameters) {
    if (p.kind != ParameterKind::kNuisance || !p.prior || p.scale != Scale::kLinear) continue;
    p.lower = p.prior->mean - kFar * p.prior->standard_deviation;
    p.upper = p.prior->mean + kFar * p.prior->standard_deviation;
  }
  return wide;
}

}  // namespace

double MarginalCost(const LeastSquares& fit, const Vector& x) {
  LeastSquares::Workspace workspace = fit.NewWorkspace();
  Vector residuals;
  SparseJacobian jacobian = fit.NewJacobian();
  if (!fit.Evaluate(x, workspace, residuals, &jacobian)) return kInfinity;
  const double cost = 0.5 * residuals.squaredNorm();
  const std::vector<int> nuisance = NuisanceVariables(fit);
  if (nuisance.empty()) return cost;
  BoxQuadraticModel model;
  if (!model.Set(x.size(), residuals, jacobian)) return kInfinity;
  return cost + HalfLogDeterminant(model, nuisance);
}

PredictedMinimum PredictMinimum(const Problem& problem, const FitSetup& setup) {
  const FitSetup wide = Unbounded(setup);
  const LeastSquares fit(problem, wide);
  LeastSquares::Workspace workspace = fit.NewWorkspace();
  Vector residuals;
  SparseJacobian jacobian = fit.NewJacobian();
  const Vector x = fit.Start();
  BoxQuadraticModel model;
  if (!fit.Evaluate(x, workspace, residuals, &jacobian) || !model.Set(x.size(), residuals, jacobian))
    return {kInfinity, setup.rest};
  double gain = 0;
  const Vector step = model.ProjectedStep(x, -1, 0, gain);
  PredictedMinimum minimum{0.5 * residuals.squaredNorm() - gain, fit.Parameters(x + step)};
  const std::vector<int> nuisance = NuisanceVariables(fit);
  if (nuisance.empty()) return minimum;
  minimum.marginal += HalfLogDeterminant(model, nuisance);
  for (const int variable : nuisance) {
    const int index = setup.free[static_cast<std::size_t>(variable)];
    const Parameter& p = setup.parameters[static_cast<std::size_t>(index)];
    const Parameter& unbounded = wide.parameters[static_cast<std::size_t>(index)];
    minimum.parameters[index] = std::clamp(minimum.parameters[index], p.lower, p.upper);
    // The determinant is that of variables whose bounds are other ones.
    minimum.marginal += std::log((p.upper - p.lower) / (unbounded.upper - unbounded.lower));
  }
  return minimum;
}

}  // namespace sinew::solvers
