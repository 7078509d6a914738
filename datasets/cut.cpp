#include "datasets/cut.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <utility>

#include "base/constants.h"
#include "base/text.h"

namespace sinew {
namespace {

constexpr double kMostPieces = 10000;
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

tl::unexpected<Error> NoTrial(const Dataset& dataset, const std::string& wanted) {
  std::vector<std::string> names;
  for (const auto& [name, trial] : dataset.trials) names.push_back(name);
  return Fail("no trial '{}'{}", wanted, names.empty() ? "; there is none" : Suggestion(wanted, names));
}

// Of any grid.
double LastSampleBefore(const Trial& trial, double time) {
  double last = -kInfinity;
  for (const auto& [name, grid] : trial.grids) {
    const auto after = std::lower_bound(grid.time.begin(), grid.time.end(), time - kSameInstant_s);
    if (after != grid.time.begin()) last = std::max(last, *std::prev(after));
  }
  return last;
}

// Errors: the window is empty or not finite, or a grid has no sample in it.
Result<Trial> PartOf(const Trial& whole, const TrialWindow& window) {
  if (!(window.margin_s >= 0) || !std::isfinite(window.margin_s)) {
    return Fail("the margin is {} s, expected 0 or more", window.margin_s);
  }
  if (!std::isfinite(window.start_s) || !std::isfinite(window.end_s)) {
    return Fail("the window {}:{} s is not finite", window.start_s, window.end_s);
  }

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
  return part;
}

}  // namespace

Status CutTrial(Dataset& dataset, const TrialWindow& window) {
  const auto source = dataset.trials.find(window.trial);
  if (source == dataset.trials.end()) return NoTrial(dataset, window.trial);
  if (dataset.trials.count(window.name) != 0) return Fail("there is a trial '{}' already", window.name);
  SINEW_ASSIGN(Trial part, PartOf(source->second, window));
  dataset.trials.emplace(window.name, std::move(part));
  return {};
}

Result<std::vector<std::string>> SplitTrial(Dataset& dataset, const std::string& trial, double length_s) {
  const auto source = dataset.trials.find(trial);
  if (source == dataset.trials.end()) return NoTrial(dataset, trial);
  if (!(length_s > 0) || !std::isfinite(length_s))
    return Fail("a piece of {} s, expected more than 0", length_s);
  double first = -kInfinity;
  double last = kInfinity;
  for (const auto& [name, grid] : source->second.grids) {
    if (grid.time.empty()) return Fail("trial '{}': grid '{}' holds no samples", trial, name);
    first = std::max(first, grid.time.front());
    last = std::min(last, grid.time.back());
  }
  if (!(first < last)) return Fail("trial '{}': its grids cover no common time", trial);
  const double pieces = std::max(std::floor((last - first) / length_s + 0.5), 1.0);
  if (pieces == 1) return std::vector<std::string>{trial};
  if (pieces > kMostPieces)
    return Fail("trial '{}' of {:.6g} s would become {:.0f} pieces, expected at most {:.0f}", trial,
                last - first, pieces, kMostPieces);
  const auto count = static_cast<int>(pieces);
  const auto digits = fmt::format("{}", count).size();
  std::map<std::string, Trial> parts;
  for (int k = 0; k < count; ++k) {
    const double begin = first + k * length_s;
    const double end = k + 1 == count ? last : LastSampleBefore(source->second, begin + length_s);
    const std::string name = fmt::format("{}_{:0{}}", trial, k + 1, digits);
    if (dataset.trials.count(name) != 0) return Fail("there is a trial '{}' already", name);
    SINEW_ASSIGN(parts[name], PartOf(source->second, {trial, begin, end, name}));
  }
  std::vector<std::string> names;
  for (const auto& [name, part] : parts) names.push_back(name);
  dataset.trials.erase(source);
  dataset.trials.merge(std::move(parts));
  return names;
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
