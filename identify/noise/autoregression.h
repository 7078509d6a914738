// Autoregressions by their partial autocorrelations: every set of them within (-1, 1) is stationary, and
// every stationary autoregression has one (Barndorff-Nielsen, Schou 1973).
#pragma once

#include <vector>

#include "base/linear_algebra.h"

namespace sinew::noise {

/// a of x_t = sum of a[i] x_{t-1-i} + innovation, by the Durbin-Levinson recursion. @return [as many as
/// given]
[[nodiscard]] std::vector<double> CoefficientsFromPartial(const std::vector<double>& partial);

/// The way back. Not every entry is within (-1, 1) if the autoregression is not stationary, and what stands
/// before such an entry means nothing.
[[nodiscard]] std::vector<double> PartialFromCoefficients(const std::vector<double>& coefficients);

/// Partial autocorrelations of stretches of one process up to `order` (Burg 1975, sums over all stretches):
/// within [-1, 1], 0 where nothing is left to predict. Stretches shorter than needed for a lag are left out
/// there.
[[nodiscard]] std::vector<double> BurgPartial(const std::vector<Vector>& stretches, int order);

/// Makes a stationary autoregression white from its first sample on, in units of its innovation: sample t is
/// predicted from all samples before it, at most `order`, and the early ones are scaled down to the
/// innovation's deviation. This is the inverse Cholesky factor of the covariance of the stretch.
class AutoregressiveFilter {
 public:
  /// @param partial [order] within [-1, 1]; where one is on the border, the samples before it become zero
  explicit AutoregressiveFilter(const std::vector<double>& partial);

  [[nodiscard]] int order() const { return static_cast<int>(predictors_.size()) - 1; }
  /// [order], of the full prediction.
  [[nodiscard]] const std::vector<double>& coefficients() const { return predictors_.back(); }
  /// In place; allocates nothing. @param x [n] one stretch
  void Apply(double* x, Eigen::Index n) const;
  /// Logarithm of the determinant of the covariance of n samples, for an innovation of variance 1.
  [[nodiscard]] double LogDeterminant(Eigen::Index n) const;

 private:
  std::vector<std::vector<double>> predictors_;  // [order + 1] from 0, 1, ... samples
  std::vector<double> scale_;  // [order + 1] deviation of the innovation over that of the error
};

}  // namespace sinew::noise
