#include "identify/solvers/marginal_cost.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <vector>

#include "base/constants.h"
#include "base/sparse_cholesky.h"
#include "identify/solvers/box_quadratic_model.h"

namespace sinew::solvers {

double MarginalCost(const LeastSquares& fit, const Vector& x) {
  LeastSquares::Workspace workspace = fit.NewWorkspace();
  Vector residuals;
  SparseJacobian jacobian = fit.NewJacobian();
  if (!fit.Evaluate(x, workspace, residuals, &jacobian)) return kInfinity;
  const double cost = 0.5 * residuals.squaredNorm();
  std::vector<int> nuisance;
  for (const int variable : fit.PriorVariables()) {
    const int index = fit.setup().free[static_cast<std::size_t>(variable)];
    if (fit.setup().parameters[static_cast<std::size_t>(index)].kind == ParameterKind::kNuisance)
      nuisance.push_back(variable);
  }
  if (nuisance.empty()) return cost;
  BoxQuadraticModel model;
  if (!model.Set(x.size(), residuals, jacobian)) return kInfinity;
  const Matrix curvature = model.normal(nuisance, nuisance);
  const SparseCholesky sparse(curvature);
  if (sparse.usable()) return cost + 0.5 * sparse.LogDeterminant();
  const Eigen::LLT<Matrix> dense(curvature);
  if (dense.info() != Eigen::Success) return kInfinity;
  return cost + dense.matrixLLT().diagonal().array().log().sum();
}

}  // namespace sinew::solvers
