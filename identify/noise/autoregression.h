// Autoregressions by their partial autocorrelations: every vector of them within (-1, 1) gives a stationary
// process, and every stationary autoregression has one (Barndorff-Nielsen, Schou 1973).
#pragma once

#include <vector>

#include "base/linear_algebra.h"

namespace sinew::noise {

/// Coefficients a of x_t = sum of a[i] x_{t-1-i} + innovation from its partial autocorrelations, by the
/// Durbin-Levinson recursion. @return [size of `partial`]
[[nodiscard]] std::vector<double> CoefficientsFromPartial(const std::vector<double>& partial);

/// The inverse of CoefficientsFromPartial. If the autoregression is not stationary, an entry is outside (-1,
/// 1), and the entries before it are not valid.
[[nodiscard]] std::vector<double> PartialFromCoefficients(const std::vector<double>& coefficients);

/// Partial autocorrelations up to `order` from stretches of one process (Burg 1975, sums over all stretches):
/// within [-1, 1], 0 where the prediction error is zero already. Stretches that are too short for a lag are
/// left out at that lag.
[[nodiscard]] std::vector<double> BurgPartial(const std::vector<Vector>& stretches, int order);

/// Whitens a stationary autoregression from its first sample on, in units of its innovation: sample t is
/// predicted from all samples before it, at most `order`, and the errors of the first samples are scaled down
/// to the innovation's deviation. This is the inverse Cholesky factor of the covariance of the stretch.
class AutoregressiveFilter {
 public:
  /// @param partial [order] within [-1, 1]; where one is -1 or 1, the samples before it become zero
  explicit AutoregressiveFilter(const std::vector<double>& partial);

  [[nodiscard]] int order() const { return static_cast<int>(predictors_.size()) - 1; }
  /// Coefficients of the prediction from `order` samples [order].
  [[nodiscard]] const std::vector<double>& coefficients() const { return predictors_.back(); }
  /// In place; allocates nothing. @param x [n] one stretch
  void Apply(double* x, Eigen::Index n) const;
  /// Logarithm of the determinant of the covariance of n samples, for an innovation of variance 1.
  [[nodiscard]] double LogDeterminant(Eigen::Index n) const;

 private:
  std::vector<std::vector<double>>
      predictors_;             // [order + 1] coefficients of the prediction from 0, 1, ... samples
  std::vector<double> scale_;  // [order + 1] innovation's deviation over that of the prediction error
};

}  // namespace sinew::noise
