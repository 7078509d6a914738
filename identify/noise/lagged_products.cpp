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

}  // namespace

LaggedProducts::LaggedProducts(const std::vector<const LaggedBlock*>& blocks, int order) {
  const int pairs = PairIndex(order, order) + 1;
  std::vector<std::vector<Matrix>> products(blocks.size());
  std::vector<bool> cut(blocks.size(), false);  // has short stretches
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const LaggedBlock& block = *blocks[b];
    const Eigen::Index m = block.rows.cols();
    products[b].assign(static_cast<std::size_t>(pairs), Matrix::Zero(m, m));
    for (std::size_t s = 0; s < block.starts.size(); ++s) {
      const Eigen::Index end = s + 1 < block.starts.size() ? block.starts[s + 1] : block.rows.rows();
      const auto stretch = block.rows.middleRows(block.starts[s], end - block.starts[s]);
      rows_ += static_cast<int>(stretch.rows());
      if (stretch.rows() < 2 * order) {
        short_.push_back({stretch, b});
        cut[b] = true;
      } else {
        AddStretch(stretch, order, products[b]);
        ++long_stretches_;
      }
    }
    columns_.push_back(block.columns);
    for (Eigen::Index c = 0; c < m; ++c) {
      for (Eigen::Index r = c; r < m; ++r) {
        const bool any = cut[b] || std::any_of(products[b].begin(), products[b].end(),
                                               [&](const Matrix& p) { return p(r, c) != 0 || p(c, r) != 0; });
        if (any) entries_.push_back({b, static_cast<std::size_t>(r), static_cast<std::size_t>(c)});
      }
    }
  }
  table_.resize(static_cast<Eigen::Index>(entries_.size()), pairs);
  for (int j = 0; j <= order; ++j) {
    for (int i = 0; i <= j; ++i) {
      const int pair = PairIndex(i, j);
      for (std::size_t e = 0; e < entries_.size(); ++e) {
        const Matrix& product = products[entries_[e].block][static_cast<std::size_t>(pair)];
        const auto r = static_cast<Eigen::Index>(entries_[e].row);
        const auto c = static_cast<Eigen::Index>(entries_[e].column);
        table_(static_cast<Eigen::Index>(e), pair) = i == j ? product(r, c) : product(r, c) + product(c, r);
      }
    }
  }
  weights_.resize(pairs);
}

int LaggedProducts::Weigh(const AutoregressiveFilter& filter, double scale) {
  const int order = filter.order();
  const auto factor = [&](int lag) {
    return lag == 0 ? 1 : -filter.coefficients()[static_cast<std::size_t>(lag - 1)];
  };
  for (int j = 0; j <= order; ++j) {
    for (int i = 0; i <= j; ++i) weights_[PairIndex(i, j)] = scale * factor(i) * factor(j);
  }
  return PairIndex(order, order) + 1;
}

void LaggedProducts::AddShort(const AutoregressiveFilter& filter, double scale, Vector& value) const {
  std::vector<Matrix> sums(columns_.size());
  for (const Short& stretch : short_) {
    Matrix rows = stretch.rows;
    for (Eigen::Index c = 0; c < rows.cols(); ++c) filter.Apply(rows.col(c).data(), rows.rows());
    Matrix& sum = sums[stretch.block];
    if (sum.size() == 0) sum = Matrix::Zero(rows.cols(), rows.cols());
    sum += rows.transpose() * rows;
  }
  for (std::size_t e = 0; e < entries_.size(); ++e) {
    const Matrix& sum = sums[entries_[e].block];
    if (sum.size() == 0) continue;
    value[static_cast<Eigen::Index>(e)] += scale * sum(static_cast<Eigen::Index>(entries_[e].row),
                                                       static_cast<Eigen::Index>(entries_[e].column));
  }
}

void LaggedProducts::Filter(const AutoregressiveFilter& filter, double scale, Vector& value) {
  const int pairs = Weigh(filter, scale);
  value.noalias() = table_.leftCols(pairs) * weights_.head(pairs);
  if (!short_.empty()) AddShort(filter, scale, value);
}

double LaggedProducts::LogDeterminant(const AutoregressiveFilter& filter) const {
  double log_determinant = long_stretches_ * filter.LogDeterminant(filter.order());
  for (const Short& stretch : short_) log_determinant += filter.LogDeterminant(stretch.rows.rows());
  return log_determinant;
}

double LaggedProducts::Differentiate(const Vector& slopes, const AutoregressiveFilter& at,
                                     const std::vector<std::array<AutoregressiveFilter, 2>>& neighbours,
                                     double step, Vector& along) {
  const int pairs = PairIndex(at.order(), at.order()) + 1;
  const Vector by_weight = table_.leftCols(pairs).transpose() * slopes;
  const auto sum = [&](const AutoregressiveFilter& filter) {
    Weigh(filter, 1);
    double value = by_weight.dot(weights_.head(pairs));
    if (short_.empty()) return value;
    Vector of_short = Vector::Zero(slopes.size());
    AddShort(filter, 1, of_short);
    return value + slopes.dot(of_short);
  };
  along.resize(static_cast<Eigen::Index>(neighbours.size()));
  for (std::size_t i = 0; i < neighbours.size(); ++i)
    along[static_cast<Eigen::Index>(i)] = (sum(neighbours[i][1]) - sum(neighbours[i][0])) / (2 * step);
  return sum(at);
}

}  // namespace sinew::noise
