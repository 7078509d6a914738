#include "problems/contact/motion/loaded_span.h"

#include <algorithm>
#include <cmath>

namespace sinew {

std::optional<std::array<double, 2>> LoadedSpan(const std::vector<double>& time,
                                                const std::vector<double>& force, double from, double to,
                                                double noise) {
  constexpr double kSurelyLoaded = 0.05;
  constexpr double kLoaded = 0.02;
  constexpr double kNoise = 4;
  double greatest = 0;
  for (const double f : force) greatest = std::isfinite(f) ? std::max(greatest, f) : greatest;
  const auto exceeds = [&](std::size_t i, double limit) {
    return force[i] > limit && time[i] >= from && time[i] <= to;
  };
  const double sure = std::max(kSurelyLoaded * greatest, kNoise * noise);
  std::size_t first = 0;
  while (first < time.size() && !exceeds(first, sure)) ++first;
  if (first == time.size()) return std::nullopt;
  std::size_t last = time.size() - 1;
  while (!exceeds(last, sure)) --last;
  while (first > 0 && exceeds(first - 1, kLoaded * greatest)) --first;
  while (last + 1 < time.size() && exceeds(last + 1, kLoaded * greatest)) ++last;
  if (!(time[last] > time[first])) return std::nullopt;
  return std::array<double, 2>{time[first], time[last]};
}

std::optional<std::array<double, 2>> WindowOf(const Trial& trial) {
  const auto start = trial.conditions.find("window_start_s");
  const auto end = trial.conditions.find("window_end_s");
  if (start == trial.conditions.end() || end == trial.conditions.end() || !(end->second > start->second))
    return {};
  return std::array<double, 2>{start->second, end->second};
}

}  // namespace sinew
