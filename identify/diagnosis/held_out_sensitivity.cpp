#include "identify/diagnosis/held_out_sensitivity.h"

#include <algorithm>
#include <cmath>

#include "base/decompositions.h"
#include "identify/role_view.h"

namespace sinew::diagnosis {
namespace {

// Variance in the unit box of a value that the training trials leave open.
constexpr double kOpen = 1;

// S with S S' = covariance, columns without a variance left out.
Matrix Root(const Matrix& covariance) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(covariance);
  const Vector scale = eigen.eigenvalues().cwiseMax(0).cwiseSqrt();
  return eigen.eigenvectors() * scale.asDiagonal();
}

}  // namespace

Result<Matrix> HeldOutSensitivity(const Problem& problem, const HeldOut& held_out, const Refit& refit,
                                  const Vector& fitted, const Matrix& covariance, Matrix& nuisance) {
  const std::vector<int>& blocks = held_out.blocks();
  const auto is_held_out = [&](const std::string& trial) {
    return std::any_of(blocks.begin(), blocks.end(),
                       [&](int b) { return problem.layout()[static_cast<std::size_t>(b)].trial == trial; });
  };
  FitSetup setup;
  setup.parameters = refit.setup->parameters;
  setup.rest = fitted;
  std::vector<int> own;
  for (std::size_t i = 0; i < setup.parameters.size(); ++i) {
    const Parameter& p = setup.parameters[i];
    const auto index = static_cast<int>(i);
    if (p.kind == ParameterKind::kNuisance && is_held_out(p.trial)) own.push_back(index);
    if (refit.setup->IsFree(index) || (!own.empty() && own.back() == index)) setup.free.push_back(index);
  }
  const RoleView view(problem, [](const Block& block) {
    return block.role == BlockRole::kValidate ? BlockRole::kTrain : BlockRole::kPredicted;
  });
  const LeastSquares fit(view, setup);
  LeastSquares::Workspace workspace = fit.NewWorkspace();
  SparseJacobian sparse = fit.NewJacobian();
  Vector residuals;
  SINEW_TRY(fit.Evaluate(fit.Variables(setup.rest), workspace, residuals, &sparse));
  const Matrix jacobian = sparse.Dense(fit.residuals(), fit.variables());

  Eigen::Index rows = 0;
  for (const int b : blocks) rows += problem.layout()[static_cast<std::size_t>(b)].samples();
  rows += static_cast<Eigen::Index>(held_out.priors().size());
  Matrix ordered = Matrix::Zero(rows, jacobian.cols());
  Eigen::Index row = 0;
  for (const int b : blocks) {
    const auto count = problem.layout()[static_cast<std::size_t>(b)].samples();
    for (const LeastSquares::TrainBlock& train : fit.train_blocks()) {
      if (train.block == b) ordered.middleRows(row, count) = jacobian.middleRows(train.first_row, count);
    }
    row += count;
  }
  const std::vector<int> with_prior = fit.PriorVariables();
  for (std::size_t i = 0; i < with_prior.size(); ++i) {
    const int parameter = setup.free[static_cast<std::size_t>(with_prior[i])];
    const auto& counted = held_out.priors();
    if (std::binary_search(counted.begin(), counted.end(), parameter))
      ordered.row(row++) = jacobian.row(fit.data_rows() + static_cast<Eigen::Index>(i));
  }
  nuisance.resize(rows, static_cast<Eigen::Index>(own.size()));
  Matrix changes = Matrix::Zero(rows, covariance.cols());
  for (std::size_t v = 0; v < setup.free.size(); ++v) {
    const auto column = ordered.col(static_cast<Eigen::Index>(v));
    const auto at = std::find(own.begin(), own.end(), setup.free[v]);
    if (at != own.end()) {
      nuisance.col(at - own.begin()) = column;
      continue;
    }
    const auto& free = refit.setup->free;
    changes.col(std::find(free.begin(), free.end(), setup.free[v]) - free.begin()) = column;
  }
  Matrix finite = covariance;
  for (Eigen::Index i = 0; i < finite.cols(); ++i) {
    if (!std::isfinite(finite(i, i))) finite(i, i) = kOpen;
  }
  return Matrix(changes * Root(finite));
}

double PredictiveDeviance(const Vector& residual, const Matrix& changes) {
  if (changes.cols() == 0) return residual.squaredNorm();
  const Matrix inner = Matrix::Identity(changes.cols(), changes.cols()) + Gram(changes);
  const Eigen::LLT<Matrix> root(inner);
  const Vector along = changes.transpose() * residual;
  const Matrix lower = root.matrixL();
  return residual.squaredNorm() - along.dot(root.solve(along)) + 2 * lower.diagonal().array().log().sum();
}

}  // namespace sinew::diagnosis
