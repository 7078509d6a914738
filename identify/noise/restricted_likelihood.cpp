#include "identify/noise/restricted_likelihood.h"

#include <algorithm>
#include <cmath>

#include "base/decompositions.h"

namespace sinew::noise {
namespace {

// Limit of the squared sine, because the decision is made on normal equations: 1e-5 of a column's length.
constexpr double kDependent = 1e-10;

/// Columns of a gram matrix with unit diagonal that are independent, by Cholesky decomposition with the
/// largest remaining diagonal first; increasing.
std::vector<int> IndependentColumns(Matrix gram) {
  const Eigen::Index k = gram.rows();
  std::vector<int> kept;
  std::vector<bool> used(static_cast<std::size_t>(k), false);
  std::vector<Eigen::Index> changed;
  for (Eigen::Index step = 0; step < k; ++step) {
    Eigen::Index pivot = -1;
    for (Eigen::Index i = 0; i < k; ++i) {
      if (!used[static_cast<std::size_t>(i)] && (pivot < 0 || gram(i, i) > gram(pivot, pivot))) pivot = i;
    }
    if (!(gram(pivot, pivot) > kDependent)) break;
    used[static_cast<std::size_t>(pivot)] = true;
    kept.push_back(static_cast<int>(pivot));
    // Most columns have no rows in common: only entries that change are visited.
    changed.clear();
    const double length = std::sqrt(gram(pivot, pivot));
    for (Eigen::Index i = 0; i < k; ++i) {
      if (!used[static_cast<std::size_t>(i)] && gram(i, pivot) != 0) changed.push_back(i);
    }
    for (const Eigen::Index c : changed) {
      const double factor = gram(c, pivot) / length;
      for (const Eigen::Index r : changed) gram(r, c) -= factor * (gram(r, pivot) / length);
    }
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

/// Replaces residuals r by those of the ordinary fit, r - X b.
void FitOrdinary(ReducedBlocks& reduced) {
  const Eigen::Index k = reduced.columns;
  if (k == 0) return;
  Matrix gram = Matrix::Zero(k, k);
  Vector projection = Vector::Zero(k);
  for (const LaggedBlock& block : reduced.blocks) {
    const Eigen::Index n = block.rows.cols() - 1;
    const Matrix product = Gram(block.rows);
    for (Eigen::Index c = 0; c < n; ++c) {
      const int column = block.columns[static_cast<std::size_t>(c)];
      projection[column] += product(n, c);
      for (Eigen::Index r = 0; r < n; ++r)
        gram(block.columns[static_cast<std::size_t>(r)], column) += product(r, c);
    }
  }
  const Vector fitted = gram.ldlt().solve(projection);
  for (LaggedBlock& block : reduced.blocks) {
    const Eigen::Index n = block.rows.cols() - 1;
    for (Eigen::Index c = 0; c < n; ++c) {
      block.rows.col(n) -= fitted[block.columns[static_cast<std::size_t>(c)]] * block.rows.col(c);
    }
  }
}

}  // namespace

ReducedBlocks Reduce(const std::vector<NoiseBlock>& blocks) {
  int all = 0;
  for (const NoiseBlock& block : blocks) {
    if (!block.columns.empty()) all = std::max(all, block.columns.back() + 1);
  }
  Matrix gram = Matrix::Zero(all, all);
  for (const NoiseBlock& block : blocks) {
    const Matrix product = Gram(block.regressors);
    for (std::size_t c = 0; c < block.columns.size(); ++c) {
      for (std::size_t r = 0; r < block.columns.size(); ++r) {
        gram(block.columns[r], block.columns[c]) +=
            product(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c));
      }
    }
  }
  Vector scale = Vector::Zero(all);
  for (int i = 0; i < all; ++i) {
    if (gram(i, i) > 0) scale[i] = 1 / std::sqrt(gram(i, i));
  }
  gram = scale.asDiagonal() * gram * scale.asDiagonal();
  const std::vector<int> kept = IndependentColumns(gram);
  std::vector<int> position(static_cast<std::size_t>(all), -1);
  for (std::size_t i = 0; i < kept.size(); ++i)
    position[static_cast<std::size_t>(kept[i])] = static_cast<int>(i);

  ReducedBlocks reduced;
  reduced.columns = static_cast<int>(kept.size());
  for (const NoiseBlock& block : blocks) {
    LaggedBlock lagged;
    std::vector<Eigen::Index> source;
    for (std::size_t c = 0; c < block.columns.size(); ++c) {
      const int at = position[static_cast<std::size_t>(block.columns[c])];
      if (at < 0) continue;
      lagged.columns.push_back(at);
      source.push_back(static_cast<Eigen::Index>(c));
    }
    const auto k = static_cast<Eigen::Index>(source.size());
    lagged.rows.resize(block.residual.size(), k + 1);
    for (Eigen::Index c = 0; c < k; ++c) {
      const Eigen::Index from = source[static_cast<std::size_t>(c)];
      lagged.rows.col(c) = block.regressors.col(from) * scale[block.columns[static_cast<std::size_t>(from)]];
    }
    lagged.rows.col(k) = block.residual;
    lagged.starts = block.stretches;
    reduced.samples += static_cast<int>(block.residual.size());
    reduced.blocks.push_back(std::move(lagged));
  }
  FitOrdinary(reduced);
  return reduced;
}

}  // namespace sinew::noise
