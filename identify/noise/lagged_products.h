// Sufficient statistics of the likelihood of an autoregression: sums of products at all pairs of lags, so
// that the cost of trying other coefficients does not depend on the number of samples.
#pragma once

#include <cstddef>
#include <vector>

#include "base/linear_algebra.h"
#include "identify/noise/autoregression.h"

namespace sinew::noise {

/// Residual and regressors of one block, in the form that the products need.
struct LaggedBlock {
  Matrix rows;               ///< [n x (k_b + 1)] regressors, then the residual
  std::vector<int> columns;  ///< [k_b] global index of each regressor
  std::vector<int> starts;   ///< first row of each stretch, increasing, starts with 0
};

/// Normal equations of a whitened least-squares fit: |W (r - X b)|^2 = power - 2 b'projection + b'gram b.
struct WhitenedNormalEquations {
  Matrix gram;        ///< [k x k] only the lower triangle
  Vector projection;  ///< [k]
  double power = 0;

  explicit WhitenedNormalEquations(int columns)
      : gram(Matrix::Zero(columns, columns)), projection(Vector::Zero(columns)) {}
};

/// Products of all rows of all blocks of one channel. The exact quadratic form of a stationary autoregression
/// over a stretch of n >= 2 order samples is sum over i, j of f_i f_j (sum over t of z_{t+i} z_{t+j}', t = 0
/// .. n-1-i-j) with f = (1, -a) (Siddiqui 1958; Box, Jenkins 1976, A7.4). Shorter stretches are filtered
/// sample by sample.
class LaggedProducts {
 public:
  /// @param order largest lag
  LaggedProducts(const std::vector<const LaggedBlock*>& blocks, int order);

  [[nodiscard]] int rows() const { return rows_; }

  /// Adds `scale` times the normal equations of the filtered rows.
  /// @param filter of at most `order` @return logarithm of the determinant of the covariance of all rows, for
  /// an innovation of variance 1
  double AddFiltered(const AutoregressiveFilter& filter, double scale, WhitenedNormalEquations& sum);

 private:
  struct Short {
    Matrix rows;
    std::size_t block = 0;
  };

  // Lower triangles of the sums of z_{t+i} z_{t+j}' + z_{t+j} z_{t+i}' (once for i = j), one column per pair
  // i <= j in the order (0,0), (0,1), (1,1), (0,2), ..., so that the pairs of a lower order come first. Rows
  // of one block after those of another.
  Matrix table_;
  std::vector<std::vector<int>> columns_;  // [blocks][k_b]
  std::vector<Short> short_;
  int long_stretches_ = 0;
  int rows_ = 0;
  Vector weights_;   // scratch
  Vector filtered_;  // scratch
};

}  // namespace sinew::noise
