#include "identify/observation/later_readings.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sinew {

LaterReadings::LaterReadings(std::vector<double> time, std::vector<double> record, std::vector<Sum> sums)
    : time_(std::move(time)), record_(std::move(record)), slope_(time_.size(), 0.0), sums_(std::move(sums)) {
  const std::size_t samples = time_.size();
  std::size_t first = 0;
  while (first < samples && !std::isfinite(record_[first])) ++first;
  double beside = first < samples ? record_[first] : 0;
  for (double& value : record_) {
    if (std::isfinite(value)) beside = value;
    value = beside;
  }
  for (std::size_t k = 1; k + 1 < samples; ++k)
    slope_[k] = (record_[k + 1] - record_[k - 1]) / (time_[k + 1] - time_[k - 1]);
}

// @param interval where to look first; set
LaterReadings::Reading LaterReadings::ReadingAt(double time, std::size_t& interval) const {
  if (time <= time_.front()) return {record_.front(), 0};
  if (time >= time_.back()) return {record_.back(), 0};
  while (time_[interval + 1] <= time) ++interval;
  while (time_[interval] > time) --interval;
  const double step = time_[interval + 1] - time_[interval];
  const double u = (time - time_[interval]) / step;
  const double rise = record_[interval + 1] - record_[interval];
  const double bend_left = step * slope_[interval] - rise;
  const double bend_right = rise - step * slope_[interval + 1];
  const double v = 1 - u;
  return {record_[interval] + u * (rise + v * (v * bend_left + u * bend_right)),
          (rise + (v - u) * (v * bend_left + u * bend_right) + u * v * (bend_right - bend_left)) / step};
}

void LaterReadings::At(double later, Eigen::Ref<Vector> changes, Eigen::Ref<Vector> slopes) const {
  std::size_t interval = 0;
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    const Sum& sum = sums_[i];
    double change = 0;
    double slope = 0;
    for (std::size_t j = 0; j < sum.coefficients.size(); ++j) {
      const std::size_t k = sum.begin + j;
      const Reading reading = ReadingAt(time_[k] + later, interval);
      change += sum.coefficients[j] * (reading.value - record_[k]);
      slope += sum.coefficients[j] * reading.slope;
    }
    changes[static_cast<Eigen::Index>(i)] = change;
    slopes[static_cast<Eigen::Index>(i)] = slope;
  }
}

}  // namespace sinew
