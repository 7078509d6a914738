#include "identify/observation/later_readings.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sinew {

LaterReadings::LaterReadings(std::vector<double> time, std::vector<double> record,
                             std::vector<double> weights, std::vector<Mean> means)
    : time_(std::move(time)),
      record_(std::move(record)),
      slope_(time_.size(), 0.0),
      weights_(std::move(weights)),
      means_(std::move(means)) {
  const auto known = [&](std::size_t k) { return std::isfinite(record_[k]) && weights_[k] > 0; };
  const std::size_t samples = time_.size();
  std::size_t first = 0;
  while (first < samples && !known(first)) ++first;
  double beside = first < samples ? record_[first] : 0;
  for (std::size_t k = 0; k < samples; ++k) {
    if (known(k)) beside = record_[k];
    record_[k] = beside;
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

void LaterReadings::At(double later, Eigen::Ref<Vector> means, Eigen::Ref<Vector> slopes) const {
  std::size_t interval = 0;
  for (std::size_t i = 0; i < means_.size(); ++i) {
    double change = 0;
    double slope = 0;
    double weights = 0;
    for (std::size_t k = means_[i].begin; k < means_[i].end; ++k) {
      const Reading reading = ReadingAt(time_[k] + later, interval);
      change += weights_[k] * (reading.value - record_[k]);
      slope += weights_[k] * reading.slope;
      weights += weights_[k];
    }
    means[static_cast<Eigen::Index>(i)] = change / weights;
    slopes[static_cast<Eigen::Index>(i)] = slope / weights;
  }
}

}  // namespace sinew
