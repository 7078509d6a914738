#include "datasets/check/time_stamps.h"

#include <algorithm>
#include <cmath>

#include "datasets/order_statistics.h"

namespace sinew {
namespace {

constexpr std::size_t kClockMinSteps = 20;
constexpr double kClockRegular = 0.02;     // largest scatter of the steps of a regular clock, of their median
constexpr double kClockMuchLonger = 1.5;   // of the median step, where the clock is regular
constexpr double kClockMuchShorter = 0.5;  // the same
constexpr double kClockBeyondUsual = 3;    // of the 99th percentile, where it is not
constexpr double kClockMostJumps = 0.02;   // of all steps: more are the way the clock works
constexpr double kOverlapOfClocks = 0.1;   // least share of the shorter grid in common with the others

void FindClockJumps(const std::string& trial, const std::string& name, const Grid& grid,
                    std::vector<Finding>& found) {
  if (grid.time.size() <= kClockMinSteps) return;
  const std::size_t count = grid.time.size() - 1;
  const auto step = [&](std::size_t i) { return grid.time[i + 1] - grid.time[i]; };
  const auto steps = [&](auto add) {
    for (std::size_t i = 0; i < count; ++i) add(step(i));
  };
  const auto levels = QuantilesOf({0.05, 0.5, 0.95, 0.99}, steps);
  const double usual = levels[1];
  const bool regular =
      RobustDeviationOf(steps) < kClockRegular * usual && levels[2] - levels[0] < kClockRegular * usual;
  const double longest = regular ? kClockMuchLonger * usual : kClockBeyondUsual * levels[3];
  const double shortest = regular ? kClockMuchShorter * usual : 0;
  Finding finding;
  finding.kind = FindingKind::kTimeJump;
  finding.trial = trial;
  finding.grid = name;
  finding.unit = "s";
  finding.usual = usual;
  for (std::size_t i = 0; i < count; ++i) {
    if (step(i) <= longest && step(i) >= shortest) continue;
    finding.spans.push_back({grid.time[i], grid.time[i + 1]});
    if (std::abs(step(i) - usual) > std::abs(finding.size - usual) || finding.spans.size() == 1)
      finding.size = step(i);
  }
  if (finding.spans.empty()) return;
  if (static_cast<double>(finding.spans.size()) > std::max(1.0, kClockMostJumps * static_cast<double>(count)))
    return;
  found.push_back(std::move(finding));
}

// A grid that shares no time with the trial's others: other units of time, or another clock.
void FindOtherClock(const std::string& trial_name, const Trial& trial, std::vector<Finding>& found) {
  if (trial.grids.size() < 2) return;
  for (const auto& [name, grid] : trial.grids) {
    bool apart = true;
    double length = 0;
    for (const auto& [other_name, other] : trial.grids) {
      if (other_name == name) continue;
      const double common =
          std::min(grid.time.back(), other.time.back()) - std::max(grid.time.front(), other.time.front());
      const double shorter =
          std::min(grid.time.back() - grid.time.front(), other.time.back() - other.time.front());
      const double longer =
          std::max(grid.time.back() - grid.time.front(), other.time.back() - other.time.front());
      if (common > kOverlapOfClocks * shorter && common > kOverlapOfClocks * longer) apart = false;
      length = std::max(length, other.time.back() - other.time.front());
    }
    if (!apart || !(length > 0)) continue;
    Finding finding;
    finding.kind = FindingKind::kTimeJump;
    finding.trial = trial_name;
    finding.grid = name;
    finding.unit = "s";
    finding.whole = true;
    finding.spans = {{grid.time.front(), grid.time.back()}};
    finding.size = grid.time.back() - grid.time.front();
    finding.usual = length;
    found.push_back(std::move(finding));
  }
}

}  // namespace

std::vector<Finding> FindTimeJumps(const Dataset& dataset) {
  std::vector<Finding> found;
  for (const auto& [trial_name, trial] : dataset.trials) {
    for (const auto& [grid_name, grid] : trial.grids) FindClockJumps(trial_name, grid_name, grid, found);
    FindOtherClock(trial_name, trial, found);
  }
  return found;
}

}  // namespace sinew
