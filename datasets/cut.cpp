#include "datasets/cut.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/text.h"

namespace sinew {
namespace {

constexpr double kSameInstant_s = 1e-9;  // smaller differences count as equal: 0.1 + 0.2 is still inside 0.3

bool KeepsMargin(const std::string& name, const Grid& grid) {
  if (name == "coordinates" || name == "markers") return true;
  return !grid.channels.empty() &&
         std::all_of(grid.channels.begin(), grid.channels.end(),
                     [](const auto& channel) { return channel.second.kind == ChannelKind::kInput; });
}

// Samples [first, last) of every channel.
Grid Slice(const Grid& grid, std::ptrdiff_t first, std::ptrdiff_t last) {
  Grid slice;
  slice.time.assign(grid.time.begin() + first, grid.time.begin() + last);
  for (const auto& [name, channel] : grid.channels) {
    slice.channels[name] = {channel.unit,
                            channel.kind,
                            channel.sigma,
                            {channel.values.begin() + first, channel.values.begin() + last}};
  }
  return slice;
}

struct Range {
  std::ptrdiff_t first;
  std::ptrdiff_t last;
};

Range SamplesWithin(const Grid& grid, double start, double end) {
  const auto first = std::lower_bound(grid.time.begin(), grid.time.end(), start - kSameInstant_s);
  const auto last = std::upper_bound(first, grid.time.end(), end + kSameInstant_s);
  return {first - grid.time.begin(), last - grid.time.begin()};
}

}  // namespace

Status CutTrial(Dataset& dataset, const TrialWindow& window) {
  const auto source = dataset.trials.find(window.trial);
  if (source == dataset.trials.end()) {
    std::vector<std::string> names;
    for (const auto& [name, trial] : dataset.trials) names.push_back(name);
    return Fail("no trial '{}'{}", window.trial,
                names.empty() ? "; there is none" : Suggestion(window.trial, names));
  }
  if (dataset.trials.count(window.name) != 0) return Fail("there is a trial '{}' already", window.name);
  if (!(window.margin_s >= 0) || !std::isfinite(window.margin_s)) {
    return Fail("the margin is {} s, expected 0 or more", window.margin_s);
  }
  if (!std::isfinite(window.start_s) || !std::isfinite(window.end_s)) {
    return Fail("the window {}:{} s is not finite", window.start_s, window.end_s);
  }

  const Trial& whole = source->second;
  Trial part;
  part.role = window.role.value_or(whole.role);
  part.task = whole.task;
  part.cut_from = whole.cut_from.empty() ? window.trial : whole.cut_from;
  part.conditions = whole.conditions;
  part.conditions["window_start_s"] = window.start_s;
  part.conditions["window_end_s"] = window.end_s;
  for (const auto& [name, grid] : whole.grids) {
    if (grid.time.empty()) return Fail("trial '{}': grid '{}' holds no samples", window.trial, name);
    const Range inside = SamplesWithin(grid, window.start_s, window.end_s);
    if (window.end_s <= window.start_s || inside.first >= inside.last) {
      return Fail("the window {}:{} s holds no sample of '{}' in trial '{}', which covers {}:{} s",
                  window.start_s, window.end_s, name, window.trial, grid.time.front(), grid.time.back());
    }
    const double margin = KeepsMargin(name, grid) ? window.margin_s : 0;
    const Range kept = SamplesWithin(grid, window.start_s - margin, window.end_s + margin);
    part.grids.emplace(name, Slice(grid, kept.first, kept.last));
  }
  dataset.trials.emplace(window.name, std::move(part));
  return {};
}

Status KeepPlates(Trial& trial, const std::vector<std::string>& plates) {
  for (const std::string& plate : plates) {
    if (!trial.Find(plate + "_force_y")) return Fail("has no channel {}_force_y", plate);
  }
  const auto is_plate = [](const std::string& channel) {
    return channel.find("_force_") != std::string::npos || channel.find("_cop_") != std::string::npos ||
           channel.find("_moment_") != std::string::npos;
  };
  const auto is_wanted = [&](const std::string& channel) {
    return std::any_of(plates.begin(), plates.end(),
                       [&](const std::string& plate) { return channel.rfind(plate + "_", 0) == 0; });
  };
  for (auto& [name, grid] : trial.grids) {
    for (auto it = grid.channels.begin(); it != grid.channels.end();)
      it = is_plate(it->first) && !is_wanted(it->first) ? grid.channels.erase(it) : std::next(it);
  }
  return {};
}

}  // namespace sinew
