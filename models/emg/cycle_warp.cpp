#include "models/emg/cycle_warp.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/numbers.h"

namespace sinew {

Result<std::vector<double>> WarpCycle(const std::vector<double>& time, const std::vector<double>& values,
                                      double begin_s, double end_s, std::size_t samples) {
  if (time.size() != values.size())
    return Fail("{} times for {} values, expected as many", time.size(), values.size());
  if (samples < 2) return Fail("{} samples for a cycle, expected at least 2", samples);
  if (!(end_s > begin_s)) {
    return Fail("a cycle from {} to {} s: expected an end behind its beginning", Readable(begin_s, 4),
                Readable(end_s, 4));
  }
  if (time.size() < 2 || !(begin_s >= time.front() && end_s <= time.back())) {
    return Fail("the cycle from {} to {} s is not covered by the samples", Readable(begin_s, 4),
                Readable(end_s, 4));
  }
  std::vector<double> curve;
  curve.reserve(samples);
  // The sample behind the instant; the last one stays it.
  auto right = static_cast<std::size_t>(std::upper_bound(time.begin(), time.end(), begin_s) - time.begin());
  right = std::min(right, time.size() - 1);
  const auto lacks = [&](double t) {
    return Fail("the cycle from {} to {} s lacks samples near {} s", Readable(begin_s, 4), Readable(end_s, 4),
                Readable(t, 4));
  };
  for (std::size_t k = 0; k < samples; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(samples - 1);
    const double t = std::min(begin_s + share * (end_s - begin_s), end_s);
    for (; time[right] < t; ++right)
      if (!std::isfinite(values[right])) return lacks(time[right]);
    const double before = values[right - 1];
    const double after = values[right];
    const double weight = (t - time[right - 1]) / (time[right] - time[right - 1]);
    // A missing neighbour that the instant does not need is no fault.
    const double value = weight >= 1 ? after : weight <= 0 ? before : before + weight * (after - before);
    if (!std::isfinite(value)) return lacks(t);
    curve.push_back(value);
  }
  return curve;
}

double AtPhase(const std::vector<double>& curve, double phase) {
  const double place = phase * static_cast<double>(curve.size() - 1);
  if (!(place > 0)) return curve.front();
  const auto left = static_cast<std::size_t>(std::min(place, static_cast<double>(curve.size() - 1)));
  if (left + 1 >= curve.size()) return curve.back();
  return curve[left] + (place - static_cast<double>(left)) * (curve[left + 1] - curve[left]);
}

std::vector<double> UnwarpCycle(const std::vector<double>& curve, double duration_s, double rate_Hz) {
  // The last instant counts although rounding may put it a little behind the end.
  const auto steps = static_cast<std::size_t>(std::floor(duration_s * rate_Hz * (1 + 1e-12) + 1e-9));
  std::vector<double> values;
  values.reserve(steps + 1);
  for (std::size_t k = 0; k <= steps; ++k)
    values.push_back(AtPhase(curve, static_cast<double>(k) / (rate_Hz * duration_s)));
  return values;
}

MeanCurve MeanOfCycles(const std::vector<std::vector<double>>& cycles) {
  if (cycles.empty()) throw std::invalid_argument("no cycles, expected at least one");
  MeanCurve curve;
  curve.cycles = cycles.size();
  const auto n = static_cast<double>(cycles.size());
  curve.mean.assign(cycles.front().size(), 0);
  for (const auto& cycle : cycles) {
    if (cycle.size() != curve.mean.size()) {
      throw std::invalid_argument(
          fmt::format("a cycle of {} samples, expected {} as the first", cycle.size(), curve.mean.size()));
    }
    for (std::size_t k = 0; k < cycle.size(); ++k) curve.mean[k] += cycle[k] / n;
  }
  if (cycles.size() < 2) return curve;
  curve.deviation.assign(curve.mean.size(), 0);
  for (const auto& cycle : cycles)
    for (std::size_t k = 0; k < cycle.size(); ++k)
      curve.deviation[k] += (cycle[k] - curve.mean[k]) * (cycle[k] - curve.mean[k]);
  for (double& value : curve.deviation) value = std::sqrt(value / (n - 1));
  return curve;
}

}  // namespace sinew
