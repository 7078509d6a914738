#include "identify/observation/delay_line.h"

#include <utility>

namespace sinew {

DelayLine::DelayLine(std::vector<double> time)
    : time_(std::move(time)), upper_(time_.size(), 0), inverse_pivot_(time_.size(), 0) {
  for (std::size_t i = 1; i + 1 < time_.size(); ++i) {
    const double left = time_[i] - time_[i - 1];
    const double right = time_[i + 1] - time_[i];
    inverse_pivot_[i] = 1 / (2 * (left + right) - left * upper_[i - 1]);
    upper_[i] = right * inverse_pivot_[i];
  }
}

void DelayLine::Fit(const Eigen::Ref<const Vector>& signal, Eigen::Ref<Vector> second) const {
  const auto n = static_cast<Eigen::Index>(time_.size());
  second[0] = 0;
  second[n - 1] = 0;
  for (Eigen::Index i = 1; i + 1 < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double left = time_[at] - time_[at - 1];
    const double right = time_[at + 1] - time_[at];
    const double slope_change = (signal[i + 1] - signal[i]) / right - (signal[i] - signal[i - 1]) / left;
    second[i] = (6 * slope_change - left * second[i - 1]) * inverse_pivot_[at];
  }
  for (Eigen::Index i = n - 2; i > 0; --i) second[i] -= upper_[static_cast<std::size_t>(i)] * second[i + 1];
}

void DelayLine::Evaluate(double delay, const Eigen::Ref<const Vector>& signal,
                         const Eigen::Ref<const Vector>& second, Eigen::Ref<Vector> value,
                         Eigen::Ref<Vector> slope) const {
  const auto n = static_cast<Eigen::Index>(time_.size());
  if (n == 1) {
    value[0] = signal[0];
    slope[0] = 0;
    return;
  }
  Eigen::Index i = 0;  // current interval of the spline; times increase
  for (Eigen::Index k = 0; k < n; ++k) {
    const double t = time_[static_cast<std::size_t>(k)] - delay;
    while (i + 2 < n && t >= time_[static_cast<std::size_t>(i + 1)]) ++i;
    const double from = time_[static_cast<std::size_t>(i)];
    const double to = time_[static_cast<std::size_t>(i + 1)];
    const double h = to - from;
    const double chord = (signal[i + 1] - signal[i]) / h;
    const double first = chord - h * (2 * second[i] + second[i + 1]) / 6;
    const double s = t - from;
    if (s < 0) {
      value[k] = signal[i] + first * s;
      slope[k] = first;
    } else if (t > to) {
      slope[k] = chord + h * (second[i] + 2 * second[i + 1]) / 6;
      value[k] = signal[i + 1] + slope[k] * (t - to);
    } else {
      const double third = (second[i + 1] - second[i]) / h;
      value[k] = signal[i] + s * (first + s * (second[i] / 2 + s * third / 6));
      slope[k] = first + s * (second[i] + s * third / 2);
    }
  }
}

}  // namespace sinew
