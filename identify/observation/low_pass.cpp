#include "identify/observation/low_pass.h"

#include <cmath>

namespace sinew {
namespace {

// 1 - exp(-a) - a exp(-a). The terms cancel for small a, where the series has a relative error of 2e-13.
double LagSlope(double a) {
  if (a < 1e-2) return a * a * (1.0 / 2 - a * (1.0 / 3 - a * (1.0 / 8 - a * (1.0 / 30 - a / 144))));
  return -std::expm1(-a) - a * std::exp(-a);
}

}  // namespace

void LowPass::Set(const std::vector<double>& time, double time_constant) {
  steps_.resize(time.size());
  time_constant_ = time_constant;
  first_step_ = time.size() > 1 ? time[1] - time[0] : 1;
  for (std::size_t i = 1; i < time.size(); ++i) {
    const double h = time[i] - time[i - 1];
    Step& step = steps_[i];
    const double a = h / time_constant;
    if (!(time_constant > 0) || std::isinf(a)) {
      step = {0, 0, 0, 1 / h};
      continue;
    }
    step.decay = std::exp(-a);
    step.lag = -std::expm1(-a) / a;
    step.decay_slope = step.decay > 0 ? step.decay * a * (a / h) : 0;
    step.lag_slope = LagSlope(a) / h;
  }
}

void LowPass::Apply(Eigen::Ref<Vector> signal) const {
  if (signal.size() < 2) return;
  double error = -time_constant_ * (signal[1] - signal[0]) / first_step_;
  double before = signal[0];
  signal[0] += error;
  for (Eigen::Index i = 1; i < signal.size(); ++i) {
    const Step& step = steps_[static_cast<std::size_t>(i)];
    error = step.decay * error - step.lag * (signal[i] - before);
    before = signal[i];
    signal[i] += error;
  }
}

void LowPass::Differentiate(const Eigen::Ref<const Vector>& signal, Eigen::Ref<Vector> slope) const {
  slope.setZero();
  if (signal.size() < 2) return;
  slope[0] = -(signal[1] - signal[0]) / first_step_;
  double error = time_constant_ * slope[0];
  for (Eigen::Index i = 1; i < signal.size(); ++i) {
    const Step& step = steps_[static_cast<std::size_t>(i)];
    const double rise = signal[i] - signal[i - 1];
    slope[i] = step.decay_slope * error + step.decay * slope[i - 1] - step.lag_slope * rise;
    error = step.decay * error - step.lag * rise;
  }
}

}  // namespace sinew
