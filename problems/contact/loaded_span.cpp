#include "problems/contact/loaded_span.h"

#include <algorithm>
#include <cmath>

namespace sinew {

std::optional<std::array<double, 2>> LoadedSpan(const std::vector<double>& time,
                                                const std::vector<double>& force, double from, double to) {
  constexpr double kLoaded = 0.02;
  double greatest = 0;
  for (const double f : force) greatest = std::isfinite(f) ? std::max(greatest, f) : greatest;
  std::optional<std::array<double, 2>> span;
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (!(force[i] > kLoaded * greatest) || time[i] < from || time[i] > to) continue;
    if (!span) span = {time[i], time[i]};
    (*span)[1] = time[i];
  }
  return span && (*span)[1] > (*span)[0] ? span : std::nullopt;
}

std::optional<std::array<double, 2>> WindowOf(const Trial& trial) {
  const auto start = trial.conditions.find("window_start_s");
  const auto end = trial.conditions.find("window_end_s");
  if (start == trial.conditions.end() || end == trial.conditions.end() || !(end->second > start->second))
    return {};
  return std::array<double, 2>{start->second, end->second};
}

}  // namespace sinew
