#include "models/emg/sampling.h"

#include <algorithm>
#include <cmath>

namespace sinew {

Result<double> UniformRate(const std::vector<double>& time) {
  if (time.size() < 2) return Fail("{} samples, expected at least 2", time.size());
  std::vector<double> steps;
  steps.reserve(time.size() - 1);
  for (std::size_t k = 1; k < time.size(); ++k) steps.push_back(time[k] - time[k - 1]);
  std::vector<double> sorted = steps;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double median = *middle;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    if (steps[k] >= 0.5 * median && steps[k] <= 1.5 * median) continue;
    return Fail(
        "the samples are not evenly spaced: a step of {:.3g} s after t = {:.4g} s, {:.3g} s elsewhere",
        steps[k], time[k], median);
  }
  return static_cast<double>(time.size() - 1) / (time.back() - time.front());
}

SampledSignal SampleAtRate(const std::vector<double>& time, const std::vector<double>& values,
                           double rate_Hz) {
  SampledSignal sampled;
  const double length_s = time.back() - time.front();
  // The last instant counts although rounding may put it a little behind the last sample.
  const auto steps = static_cast<std::size_t>(std::floor(length_s * rate_Hz * (1 + 1e-12) + 1e-9));
  sampled.time.reserve(steps + 1);
  sampled.values.reserve(steps + 1);
  std::size_t right = 0;
  for (std::size_t k = 0; k <= steps; ++k) {
    const double t = std::min(time.front() + static_cast<double>(k) / rate_Hz, time.back());
    while (time[right] < t) ++right;
    double value = values[right];
    if (time[right] > t) {
      const double share = (t - time[right - 1]) / (time[right] - time[right - 1]);
      value = values[right - 1] + share * (values[right] - values[right - 1]);
    }
    sampled.time.push_back(t);
    sampled.values.push_back(value);
  }
  return sampled;
}

}  // namespace sinew
