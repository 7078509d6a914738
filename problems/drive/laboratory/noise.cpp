#include "problems/drive/laboratory/noise.h"

#include <cmath>

namespace sinew {

Vector DriveNoise::Draw(Eigen::Index count, Random& random) const {
  Vector noise(count);
  const double white = sigma * std::sqrt(1 - slow_share);
  const double step = sigma * std::sqrt(slow_share * (1 - rho * rho));
  double slow = sigma * std::sqrt(slow_share) * random.Normal();
  for (double& value : noise) {
    value = slow + white * random.Normal();
    slow = rho * slow + step * random.Normal();
  }
  return noise;
}

void DriveNoise::Whiten(Eigen::Ref<Matrix> signals) const {
  const double white = sigma * sigma * (1 - slow_share);
  const double stationary = sigma * sigma * slow_share;
  const double step = stationary * (1 - rho * rho);
  Eigen::RowVectorXd mean = Eigen::RowVectorXd::Zero(signals.cols());  // of the slow part, predicted
  double variance = stationary;
  for (Eigen::Index i = 0; i < signals.rows(); ++i) {
    const double total = variance + white;
    const double gain = variance / total;
    signals.row(i) -= mean;
    mean = rho * (mean + gain * signals.row(i));
    signals.row(i) /= std::sqrt(total);
    variance = rho * rho * variance * (1 - gain) + step;
  }
}

}  // namespace sinew
