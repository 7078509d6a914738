// Sufficient statistics of the likelihood of an autoregression: sums of products at all pairs of lags, so
// that the cost of trying other coefficients does not depend on the number of samples.
#pragma once

#include <array>
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

/// Products of all rows of all blocks of one channel. The exact quadratic form of a stationary autoregression
/// over a stretch of n >= 2 order samples is sum over i, j of f_i f_j (sum over t of z_{t+i} z_{t+j}', t = 0
/// .. n-1-i-j) with f = (1, -a) (Siddiqui 1958; Box, Jenkins 1976, A7.4). Shorter stretches are filtered
/// sample by sample.
class LaggedProducts {
 public:
  /// @param order largest lag
  LaggedProducts(const std::vector<const LaggedBlock*>& blocks, int order);

  [[nodiscard]] int rows() const { return rows_; }

  /// A product of two columns of a block's rows whose sums are not all zero.
  struct Entry {
    std::size_t block = 0;
    std::size_t row = 0;     ///< >= column
    std::size_t column = 0;  ///< 0 .. k_b; the last one is the residual
  };
  /// One block after the other.
  [[nodiscard]] const std::vector<Entry>& entries() const { return entries_; }
  /// [blocks][k_b] global index of each regressor.
  [[nodiscard]] const std::vector<std::vector<int>>& columns() const { return columns_; }

  /// `scale` times the sums of the products of the filtered rows. @param filter of at most `order`
  /// @param value [entries]
  void Filter(const AutoregressiveFilter& filter, double scale, Vector& value);
  /// Logarithm of the determinant of the covariance of all rows, for an innovation of variance 1.
  [[nodiscard]] double LogDeterminant(const AutoregressiveFilter& filter) const;

  /// Derivative of the sum of slopes[i] value[i] of Filter(), at scale 1, by x in direction i of
  /// `neighbours`, from filters on both sides.
  /// @param slopes [entries] @param neighbours [i] filters at x - step and x + step, of the same order
  /// @param at the filter at x @param along [i] @return the sum itself
  double Differentiate(const Vector& slopes, const AutoregressiveFilter& at,
                       const std::vector<std::array<AutoregressiveFilter, 2>>& neighbours, double step,
                       Vector& along);

 private:
  struct Short {
    Matrix rows;
    std::size_t block = 0;
  };

  // Weights of the pairs of lags of a filter, into weights_. @return their number
  int Weigh(const AutoregressiveFilter& filter, double scale);
  // The products of the short stretches, times `scale`, in the order of all_.
  void AddShort(const AutoregressiveFilter& filter, double scale, Vector& value) const;

  // Sums of z_{t+i} z_{t+j}' + z_{t+j} z_{t+i}' (once for i = j), one row per entry, one column per pair
  // i <= j in the order (0,0), (0,1), (1,1), (0,2), ..., so that the pairs of a lower order come first.
  Matrix table_;
  std::vector<Entry> entries_;
  std::vector<std::vector<int>> columns_;  // [blocks][k_b]
  std::vector<Short> short_;
  int long_stretches_ = 0;
  int rows_ = 0;
  Vector weights_;  // scratch
};

}  // namespace sinew::noise
