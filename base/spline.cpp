#include "base/spline.h"

#include <algorithm>
#include <cmath>

namespace sinew {

Status CheckSplineSamples(const std::vector<double>& time, const std::vector<double>& values,
                          std::size_t least) {
  const std::size_t n = time.size();
  if (values.size() != n) return Fail("spline: {} times but {} values", n, values.size());
  if (n < least) return Fail("spline: {} sample(s), expected at least {}", n, least);
  for (std::size_t i = 0; i < n; ++i) {
    if (!std::isfinite(time[i]) || !std::isfinite(values[i]))
      return Fail("spline: sample {} is not finite", i);
    if (i > 0 && time[i] <= time[i - 1]) return Fail("spline: time does not increase at sample {}", i);
  }
  return {};
}

Result<NaturalCubicSpline> NaturalCubicSpline::Fit(std::vector<double> time, std::vector<double> values) {
  SINEW_TRY(CheckSplineSamples(time, values, 2));
  const std::size_t n = time.size();

  // Tridiagonal system for the second derivatives (Thomas algorithm; diagonally dominant, so it needs no
  // pivots).
  std::vector<double> second(n, 0.0);
  std::vector<double> upper(n, 0.0);
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double left = time[i] - time[i - 1];
    const double right = time[i + 1] - time[i];
    const double slope_change = (values[i + 1] - values[i]) / right - (values[i] - values[i - 1]) / left;
    const double diagonal = 2 * (left + right) - left * upper[i - 1];
    upper[i] = right / diagonal;
    second[i] = (6 * slope_change - left * second[i - 1]) / diagonal;
  }
  for (std::size_t i = n - 1; i-- > 1;) second[i] -= upper[i] * second[i + 1];

  NaturalCubicSpline spline;
  spline.time_ = std::move(time);
  spline.values_ = std::move(values);
  spline.second_ = std::move(second);
  return spline;
}

NaturalCubicSpline::Value NaturalCubicSpline::At(double t) const {
  const auto after = std::upper_bound(time_.begin() + 1, time_.end() - 1, t);
  const auto j = static_cast<std::size_t>(after - time_.begin());
  const std::size_t i = j - 1;
  const double h = time_[j] - time_[i];
  const double slope = (values_[j] - values_[i]) / h;
  const double first_at_i = slope - h * (2 * second_[i] + second_[j]) / 6;
  const double first_at_j = slope + h * (second_[i] + 2 * second_[j]) / 6;
  if (t < time_.front()) return {values_.front() + first_at_i * (t - time_.front()), first_at_i, 0};
  if (t > time_.back()) return {values_.back() + first_at_j * (t - time_.back()), first_at_j, 0};

  const double s = t - time_[i];
  const double third = (second_[j] - second_[i]) / h;
  return {values_[i] + s * (first_at_i + s * (second_[i] / 2 + s * third / 6)),
          first_at_i + s * (second_[i] + s * third / 2), second_[i] + s * third};
}

}  // namespace sinew
