#include "identify/uncertainty/information.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/column_space.h"
#include "base/decompositions.h"
#include "identify/uncertainty/verdict.h"

namespace sinew::uncertainty {
namespace {

Matrix Columns(const Matrix& jacobian, const std::vector<int>& which) {
  Matrix columns(jacobian.rows(), static_cast<Eigen::Index>(which.size()));
  for (std::size_t i = 0; i < which.size(); ++i) {
    columns.col(static_cast<Eigen::Index>(i)) = jacobian.col(which[i]);
  }
  return columns;
}

/// Takes the space of the nuisance columns out of info.columns.
void ProjectOut(const Matrix& jacobian, Information& info) {
  const auto h = static_cast<Eigen::Index>(info.nuisance.size());
  const Eigen::Index k = info.columns.cols();
  info.nuisance_share = Matrix::Zero(h, k);
  if (h == 0) return;
  Matrix nuisance = Columns(jacobian, info.nuisance);
  for (Eigen::Index i = 0; i < h; ++i) nuisance.col(i).normalize();
  const ColumnSpace space(nuisance, kRankTolerance);
  info.leverage += space.Leverage();
  const Matrix parts = space.Solve(info.columns);
  info.columns = space.TakenFrom(info.columns);
  info.columns = space.TakenFrom(info.columns);  // again: the first leaves rounding errors
  for (Eigen::Index j = 0; j < k; ++j) {
    if (info.full_norm[j] > 0) info.nuisance_share.col(j) = parts.col(j).cwiseAbs() / info.full_norm[j];
  }
}

}  // namespace

int Information::index_of(int variable) const {
  const auto found = std::find(variables.begin(), variables.end(), variable);
  return found == variables.end() ? -1 : static_cast<int>(found - variables.begin());
}

Information MakeInformation(const Matrix& jacobian, const std::vector<int>& variables,
                            const std::vector<int>& nuisance) {
  Information info;
  info.variables = variables;
  std::copy_if(nuisance.begin(), nuisance.end(), std::back_inserter(info.nuisance),
               [&](int v) { return jacobian.col(v).squaredNorm() > 0; });
  info.columns = Columns(jacobian, variables);
  info.full_norm = info.columns.colwise().norm();
  info.leverage = Vector::Zero(jacobian.rows());
  ProjectOut(jacobian, info);
  info.norm = info.columns.colwise().norm();

  const auto k = static_cast<Eigen::Index>(variables.size());
  // At least k rows, so that every direction has its singular value.
  Matrix scaled = Matrix::Zero(std::max(jacobian.rows(), k), k);
  for (Eigen::Index j = 0; j < k; ++j) {
    const bool lost = !(info.norm[j] > kRankTolerance * info.full_norm[j]);
    info.lost_to_nuisance.push_back(lost);
    if (!lost) scaled.col(j).head(jacobian.rows()) = info.columns.col(j) / info.norm[j];
  }
  info.inverse = Matrix::Zero(k, k);
  info.determined.assign(variables.size(), true);
  if (k == 0) return info;

  const Eigen::JacobiSVD<Matrix> svd(scaled, Eigen::ComputeThinU | Eigen::ComputeThinV);
  info.singular_values = svd.singularValues();
  info.directions = svd.matrixV();
  Matrix root = Matrix::Zero(k, k);  // inverse = root * root'
  for (Eigen::Index i = 0; i < k; ++i) {
    if (info.singular_values[i] > kRankTolerance * info.singular_values[0]) {
      ++info.rank;
      info.leverage += svd.matrixU().col(i).head(jacobian.rows()).cwiseAbs2();
      root.col(i) = info.directions.col(i) / info.singular_values[i];
      continue;
    }
    for (Eigen::Index j = 0; j < k; ++j) {
      if (std::abs(info.directions(j, i)) > kTakesPart) info.determined[static_cast<std::size_t>(j)] = false;
    }
  }
  for (Eigen::Index j = 0; j < k; ++j) {
    if (info.lost_to_nuisance[static_cast<std::size_t>(j)]) {
      info.determined[static_cast<std::size_t>(j)] = false;
      root.row(j).setZero();
    } else {
      root.row(j) /= info.norm[j];
    }
  }
  info.inverse = root * root.transpose();
  return info;
}

}  // namespace sinew::uncertainty
