// Measurement noise with a memory, and the exact whitening that undoes it.
#pragma once

#include "base/linear_algebra.h"
#include "base/random.h"

namespace sinew {

/// Stationary Gaussian noise: a white part plus a slow part whose samples have the correlation rho^|k|.
///
///   covariance of samples i, j = sigma^2 ((1 - slow_share) [i = j] + slow_share rho^|i - j|)
///
/// White for slow_share 0; AR(1) for slow_share 1; between them ARMA(1,1), which no finite AR is.
struct DriveNoise {
  double sigma = 0;       ///< [unit of the channel, >= 0] standard deviation of the whole
  double slow_share = 0;  ///< [0 .. 1] of the variance
  double rho = 0;         ///< [0 .. 1) correlation of neighbouring samples of the slow part

  /// @return [count] one recording.
  [[nodiscard]] Vector Draw(Eigen::Index count, Random& random) const;

  /// L^-1 x for every column x, L the Cholesky factor of the covariance: the innovations of the Kalman
  /// filter of this noise, divided by their standard deviations; sigma > 0. @param signals [N x K] one
  /// recording per column.
  void Whiten(Eigen::Ref<Matrix> signals) const;
};

}  // namespace sinew
