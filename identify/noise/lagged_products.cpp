#include "identify/noise/lagged_products.h"

#include <algorithm>

namespace sinew::noise {
namespace {

int PairIndex(int i, int j) {
  return j * (j + 1) / 2 + i;
}

/// Adds the products of one stretch of at least 2 order rows to `products` [pairs].
void AddStretch(const Eigen::Ref<const Matrix>& z, int order, std::vector<Matrix>& products) {
  const Eigen::Index n = z.rows();
  for (int lag = 0; lag <= order; ++lag) {
    // Sum of z_u z_{u+lag}' over u = i .. n-1-i-lag, from the largest i, which has the fewest terms, to 0.
    const int largest = order - lag;
    const Eigen::Index count = n - largest - order;
    Matrix product = z.middleRows(largest, count).transpose() * z.middleRows(largest + lag, count);
    for (int i = largest; i >= 0; --i) {
      if (i < largest) {
        product.noalias() += z.row(i).transpose() * z.row(i + lag);
        product.noalias() += z.row(n - 1 - i - lag).transpose() * z.row(n - 1 - i);
      }
      products[static_cast<std::size_t>(PairIndex(i, i + lag))] += product;
    }
  }
}

/// Adds entry (r, c) of the products of [regressors, residual] to its place in the normal equations.
void AddEntry(const std::vector<int>& columns, int r, int c, double value, WhitenedNormalEquations& sum) {
  const auto k = static_cast<int>(columns.size());
  if (c == k) {
    sum.power += value;
    return;
  }
  const int column = columns[static_cast<std::size_t>(c)];
  if (r == k) {
    sum.projection[column] += value;
  } else {
    const auto [low, high] = std::minmax(column, columns[static_cast<std::size_t>(r)]);
    sum.gram(high, low) += value;
  }
}

}  // namespace

LaggedProducts::LaggedProducts(const std::vector<const LaggedBlock*>& blocks, int order) {
  const int pairs = PairIndex(order, order) + 1;
  Eigen::Index height = 0;
  for (const LaggedBlock* block : blocks) height += block->rows.cols() * (block->rows.cols() + 1) / 2;
  table_.resize(height, pairs);
  Eigen::Index at = 0;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const LaggedBlock& block = *blocks[b];
    const Eigen::Index m = block.rows.cols();
    std::vector<Matrix> products(static_cast<std::size_t>(pairs), Matrix::Zero(m, m));
    for (std::size_t s = 0; s < block.starts.size(); ++s) {
      const Eigen::Index end = s + 1 < block.starts.size() ? block.starts[s + 1] : block.rows.rows();
      const auto stretch = block.rows.middleRows(block.starts[s], end - block.starts[s]);
      rows_ += static_cast<int>(stretch.rows());
      if (stretch.rows() < 2 * order) {
        short_.push_back({stretch, b});
      } else {
        AddStretch(stretch, order, products);
        ++long_stretches_;
      }
    }
    for (int j = 0; j <= order; ++j) {
      for (int i = 0; i <= j; ++i) {
        const Matrix& product = products[static_cast<std::size_t>(PairIndex(i, j))];
        Eigen::Index row = at;
        for (Eigen::Index c = 0; c < m; ++c) {
          for (Eigen::Index r = c; r < m; ++r) {
            table_(row++, PairIndex(i, j)) = i == j ? product(r, c) : product(r, c) + product(c, r);
          }
        }
      }
    }
    at += m * (m + 1) / 2;
    columns_.push_back(block.columns);
  }
  weights_.resize(pairs);
  filtered_.resize(height);
}

double LaggedProducts::AddFiltered(const AutoregressiveFilter& filter, double scale,
                                   WhitenedNormalEquations& sum) {
  const int order = filter.order();
  const auto factor = [&](int lag) {
    return lag == 0 ? 1 : -filter.coefficients()[static_cast<std::size_t>(lag - 1)];
  };
  const int pairs = PairIndex(order, order) + 1;
  for (int j = 0; j <= order; ++j) {
    for (int i = 0; i <= j; ++i) weights_[PairIndex(i, j)] = scale * factor(i) * factor(j);
  }
  filtered_.noalias() = table_.leftCols(pairs) * weights_.head(pairs);
  const double* value = filtered_.data();
  for (const std::vector<int>& columns : columns_) {
    const auto k = static_cast<int>(columns.size());
    for (int c = 0; c <= k; ++c) {
      for (int r = c; r <= k; ++r) AddEntry(columns, r, c, *value++, sum);
    }
  }
  double log_determinant = long_stretches_ * filter.LogDeterminant(order);
  for (const Short& stretch : short_) {
    Matrix rows = stretch.rows;
    for (Eigen::Index c = 0; c < rows.cols(); ++c) filter.Apply(rows.col(c).data(), rows.rows());
    const Matrix product = scale * rows.transpose() * rows;
    const auto k = static_cast<int>(rows.cols()) - 1;
    for (int c = 0; c <= k; ++c) {
      for (int r = c; r <= k; ++r) AddEntry(columns_[stretch.block], r, c, product(r, c), sum);
    }
    log_determinant += filter.LogDeterminant(rows.rows());
  }
  return log_determinant;
}

}  // namespace sinew::noise
