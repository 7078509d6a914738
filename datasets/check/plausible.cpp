#include "datasets/check/plausible.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "datasets/check/cycles.h"
#include "datasets/check/sides.h"
#include "datasets/lagged_correlation.h"
#include "datasets/order_statistics.h"
#include "datasets/robust.h"
#include "datasets/stances/stances.h"

namespace sinew {
namespace {

constexpr double kScaleTolerance = 2.5;  // factor around 57.3 or 1000
constexpr double kScaleMostSpread = 25;  // largest factor between the other trials
constexpr double kScaleApart = 8;        // least factor between this trial and the nearest of them
constexpr double kGravity = 9.80665;     // [m/s2]
constexpr double kSideways = 1.5;        // of the vertical force
constexpr double kMuchLarger = 10;       // the same: of another unit, not along another axis
constexpr double kDerivativeHolds = 0.9;
constexpr double kMostTurns_rad = 25;  // range of a joint
constexpr double kFarFromMarkers_m = 2;

// 57.3, 1000 or an inverse, if the ratio is near it.
std::optional<double> UnitNear(double ratio, double tolerance) {
  for (const double unit : {57.29577951308232, 1000.0}) {
    for (const double factor : {unit, 1 / unit}) {
      if (ratio < factor * tolerance && ratio > factor / tolerance) return factor;
    }
  }
  return std::nullopt;
}

// 57.3, 1000 or an inverse, if the size of one trial is apart from those of all others by about that.
std::optional<double> OddScale(const std::vector<double>& sizes, std::size_t s) {
  std::vector<double> others;
  for (std::size_t u = 0; u < sizes.size(); ++u) {
    if (u != s && sizes[u] != 0) others.push_back(std::abs(sizes[u]));
  }
  const double size = std::abs(sizes[s]);
  if (others.size() < 2 || size == 0) return std::nullopt;
  const auto [low, high] = std::minmax_element(others.begin(), others.end());
  const double spread = *high / *low;
  const auto factor =
      UnitNear(size / Median(others), std::max(kScaleTolerance, std::min(spread, kScaleMostSpread)));
  if (!factor || spread > kScaleMostSpread) return std::nullopt;
  const double apart = size > *high ? size / *high : *low / size;
  // Further from the nearest of them than they are from each other.
  if (apart < std::max(kScaleApart, spread)) return std::nullopt;
  return factor;
}

using OfTrial = std::map<std::string, const Signal*>;  // channels by name; of several grids the first

Finding WholeFinding(const Signal& signal, FindingKind kind, double size, double usual,
                     const std::string& other) {
  Finding finding = signal.Found(kind);
  finding.whole = true;
  finding.spans = {signal.Whole()};
  finding.size = size;
  finding.usual = usual;
  finding.other = other;
  return finding;
}

const Signal* Get(const OfTrial& channels, const std::string& name) {
  const auto found = channels.find(name);
  return found == channels.end() ? nullptr : found->second;
}

double LargestOf(const Signal* signal) {
  if (signal == nullptr) return 0;
  const double largest = QuantileOf(0.98, [&](auto add) {
    for (const double v : signal->values) {
      if (std::isfinite(v)) add(std::abs(v));
    }
  });
  return std::isfinite(largest) ? largest : 0;
}

void CheckForces(const Dataset& dataset, const std::string& plate, const OfTrial& channels,
                 std::vector<Finding>& found) {
  const Signal* up = Get(channels, plate + "_force_y");
  if (up == nullptr) return;
  const double vertical = LargestOf(up);
  const auto mass = dataset.constants.find("body_mass");
  for (const char* axis : {"_force_x", "_force_z"}) {
    const Signal* side = Get(channels, plate + axis);
    const double sideways = LargestOf(side);
    if (sideways > kMuchLarger * vertical && vertical > 0) {
      found.push_back(WholeFinding(*side, FindingKind::kUnit,
                                   sideways > 200 * vertical ? 1000 : 57.29577951308232, 1, ""));
      continue;
    }
    if (sideways > kSideways * vertical && vertical > 0) {
      found.push_back(WholeFinding(*up, FindingKind::kAxis, sideways, vertical, side->channel));
      return;
    }
  }
  if (!(vertical > 0)) return;
  const double loaded = QuantileOf(0.5, [&](auto add) {
    for (const double v : up->values) {
      if (std::isfinite(v) && std::abs(v) > 0.2 * vertical) add(v);
    }
  });
  if (loaded < 0) found.push_back(WholeFinding(*up, FindingKind::kSign, -1, 1, ""));
  if (mass != dataset.constants.end() && mass->second.value > 0) {
    const double weights = vertical / (mass->second.value * kGravity);
    if (weights > 30 || weights < 0.01)
      found.push_back(WholeFinding(*up, FindingKind::kUnit, weights > 30 ? 1000 : 1e-3, 1, ""));
  }
  for (const char* axis : {"_force_x", "_force_z"}) {
    const Signal* side = Get(channels, plate + axis);
    const double sideways = LargestOf(side);
    // A hundredth of a percent of the load is not what a foot does.
    if (sideways > 0 && sideways < 3e-4 * vertical)
      found.push_back(WholeFinding(*side, FindingKind::kUnit, 1e-3, 1, ""));
  }
}

// Lowest and highest of the markers' coordinates along an axis.
std::optional<TimeSpan> MarkerRange(const OfTrial& channels, const std::string& axis) {
  std::vector<double> middles;
  for (const auto& [name, signal] : channels) {
    if (signal->grid != "markers" || name.size() < 2 || name.compare(name.size() - 2, 2, axis) != 0) continue;
    const auto ends = FiniteQuantiles(signal->values, {0.02, 0.98});
    if (std::isfinite(ends.front())) middles.insert(middles.end(), ends.begin(), ends.end());
  }
  if (middles.size() < 10) return std::nullopt;
  return TimeSpan{Quantile(middles, 0.02), Quantile(middles, 0.98)};
}

void CheckPressure(const std::string& plate, const OfTrial& channels, std::vector<Finding>& found) {
  for (const char* axis : {"_x", "_z"}) {
    const Signal* cop = Get(channels, plate + "_cop" + axis);
    const auto markers = MarkerRange(channels, axis);
    if (cop == nullptr || !markers) continue;
    if (CountFinite(cop->values) < 10) continue;
    const double middle = FiniteQuantiles(cop->values, {0.5}).front();
    const double away = std::max(markers->from - middle, middle - markers->to);
    if (!(away > kFarFromMarkers_m)) continue;
    const double reach = std::max(std::abs(markers->from), std::abs(markers->to));
    if (std::abs(middle) > 20 * reach) found.push_back(WholeFinding(*cop, FindingKind::kUnit, 1000, 1, ""));
  }
}

// Markers: each next to the others of its axis.
void CheckMarkers(const OfTrial& channels, std::vector<Finding>& found) {
  for (const std::string axis : {"_x", "_y", "_z"}) {
    std::vector<const Signal*> markers;
    std::vector<double> levels;
    for (const auto& [name, signal] : channels) {
      if (signal->grid != "markers" || name.size() < 3 || name.compare(name.size() - 2, 2, axis) != 0)
        continue;
      if (CountFinite(signal->values) < 10) continue;
      markers.push_back(signal);
      levels.push_back(FiniteQuantiles(signal->values, {0.5}).front());
    }
    if (markers.size() < 8) continue;
    const double middle = Median(levels);
    std::vector<double> sizes;
    for (const double level : levels) sizes.push_back(std::abs(level));
    const double reach = std::max(Quantile(sizes, 0.9), 0.1);
    const double scatter = std::max(RobustDeviation(levels), 0.05);
    for (std::size_t i = 0; i < markers.size(); ++i) {
      const double size = std::abs(levels[i]);
      if (size > 15 * reach) {
        found.push_back(
            WholeFinding(*markers[i], FindingKind::kUnit, size > 150 * reach ? 1000 : 57.3, 1, ""));
      } else if (std::abs(levels[i] - middle) > 6 * scatter + 0.5) {
        // It lies where it would with the other sign.
        const bool mirrored = std::abs(-levels[i] - middle) < 3 * scatter;
        if (mirrored) found.push_back(WholeFinding(*markers[i], FindingKind::kSign, -1, 1, ""));
      }
    }
    // Walking markers move together: one that runs the other way has the wrong sign.
    if (axis != "_x") continue;
    for (const Signal* marker : markers) {
      std::vector<double> r;
      for (const Signal* other : markers) {
        if (other != marker && other->size() == marker->size())
          r.push_back(Correlation(marker->values, other->values));
      }
      r = Finite(r);
      if (r.size() >= 8 && Median(r) < -0.95 &&
          std::none_of(found.begin(), found.end(), [&](const Finding& f) {
            return f.channel == marker->channel && f.trial == marker->trial;
          }))
        found.push_back(WholeFinding(*marker, FindingKind::kSign, -1, 1, ""));
    }
  }
}

// Positions and speeds of one grid: by name, or the only pair of units u and u/s.
void CheckSpeeds(const OfTrial& channels, std::vector<Finding>& found) {
  for (const auto& [name, speed] : channels) {
    const std::string& unit = speed->unit;
    if (unit.size() < 3 || unit.compare(unit.size() - 2, 2, "/s") != 0) continue;
    const std::string wanted = unit.substr(0, unit.size() - 2);
    const Signal* position = nullptr;
    int candidates = 0;
    for (const auto& [other_name, other] : channels) {
      if (other->grid != speed->grid || other->unit != wanted || other->kind != speed->kind) continue;
      position = other;
      ++candidates;
    }
    if (name == "speed" && Get(channels, "position") != nullptr) {
      position = Get(channels, "position");
      candidates = 1;
    }
    if (candidates != 1 || position->size() != speed->size() || speed->size() < 50) continue;
    const auto& t = *speed->time;
    std::vector<double> slope(speed->size(), NAN);
    for (std::size_t i = 2; i + 2 < slope.size(); ++i)
      slope[i] = (position->values[i + 2] - position->values[i - 2]) / (t[i + 2] - t[i - 2]);
    const double r = Correlation(slope, speed->values);
    if (r < -kDerivativeHolds) {
      found.push_back(WholeFinding(*speed, FindingKind::kSign, r, 1, position->channel));
      continue;
    }
    const Signal rate{{}, {}, {}, {}, {}, {}, {}, speed->time, slope};
    const double range = RangeOf(rate);
    const auto unit_factor = range > 0 ? UnitNear(RangeOf(*speed) / range, 1.5) : std::nullopt;
    if (r > kDerivativeHolds && unit_factor) {
      found.push_back(WholeFinding(*speed, FindingKind::kUnit, *unit_factor, 1, position->channel));
      continue;
    }
    const double step = QuantileOf(0.5, [&](auto add) {
      for (std::size_t i = 1; i < t.size(); ++i) add(t[i] - t[i - 1]);
    });
    double best = r;
    int best_lag = 0;
    const int longest = static_cast<int>(std::min<double>(0.4 / step, static_cast<double>(slope.size()) / 4));
    const std::vector<double> of_lags = LaggedCorrelations(slope, speed->values, longest);
    for (int lag = -longest; lag <= longest; ++lag) {
      const double at = of_lags[static_cast<std::size_t>(lag + longest)];
      if (at > best) {
        best = at;
        best_lag = lag;
      }
    }
    if (best > kDerivativeHolds && std::abs(best_lag) >= 3 && 1 - best < 0.3 * (1 - r))
      found.push_back(WholeFinding(*speed, FindingKind::kLag, best_lag * step, 0, position->channel));
  }
}

void CheckSides(const OfTrial& channels, std::vector<Finding>& found) {
  for (const auto& [name, signal] : channels) {
    std::string other_name;
    const Signal* other = nullptr;
    for (const std::string& candidate : OtherSides(name)) {
      if (other != nullptr) break;
      other = Get(channels, candidate);
      other_name = candidate;
    }
    if (other == nullptr || other->unit != signal->unit || signal->grid == "markers" ||
        other->grid != signal->grid || name > other_name)
      continue;
    if (name.find("_force_") != std::string::npos && name.find("_force_y") == std::string::npos) continue;
    const double mine = RangeOf(*signal);
    const double theirs = RangeOf(*other);
    if (!(mine > 0 && theirs > 0)) continue;
    const auto factor = UnitNear(mine / theirs, 2);
    if (!factor) continue;
    // Which of the two? The one that is further from the other channels of this unit and grid.
    std::vector<double> logs;
    for (const auto& [unused, peer] : channels) {
      const double range = RangeOf(*peer);
      if (peer != signal && peer != other && peer->unit == signal->unit && peer->grid == signal->grid &&
          range > 0)
        logs.push_back(std::log(range));
    }
    bool mine_is_wrong = mine > theirs;
    if (!logs.empty())
      mine_is_wrong = std::abs(std::log(mine) - Median(logs)) > std::abs(std::log(theirs) - Median(logs));
    const Signal& wrong = mine_is_wrong ? *signal : *other;
    Finding finding = WholeFinding(wrong, FindingKind::kUnit, mine_is_wrong ? *factor : 1 / *factor, 1,
                                   mine_is_wrong ? other_name : name);
    found.push_back(std::move(finding));
  }
}

// Activities of muscles are positive, of all of a recording: one that is negative has the wrong sign.
void CheckActivities(const OfTrial& channels, std::vector<Finding>& found) {
  constexpr std::size_t kFewest = 3;  // others
  constexpr double kBeyond = 0.1;     // share of the range that noise may be on the other side of 0
  std::map<std::string, std::vector<const Signal*>> positive;
  std::map<std::string, std::vector<const Signal*>> negative;
  std::map<std::string, std::size_t> count;
  for (const auto& [name, signal] : channels) {
    // Components of a vector or a quaternion have any sign.
    const bool component =
        name.size() > 2 && name[name.size() - 2] == '_' && name.back() >= 'w' && name.back() <= 'z';
    if ((signal->unit != "1" && signal->unit != "V") || component) continue;
    const double range = RangeOf(*signal);
    if (!(range > 0)) continue;
    ++count[signal->grid];
    const auto ends = FiniteQuantiles(signal->values, {0.02, 0.98});
    if (ends[0] > -kBeyond * range) positive[signal->grid].push_back(signal);
    if (ends[1] < kBeyond * range) negative[signal->grid].push_back(signal);
  }
  for (const auto& [grid, wrong] : negative) {
    if (wrong.size() != 1 || positive[grid].size() < kFewest || positive[grid].size() + 1 != count[grid])
      continue;
    found.push_back(WholeFinding(*wrong.front(), FindingKind::kSign, -1, 1, ""));
  }
}

void CheckAngles(const OfTrial& channels, std::vector<Finding>& found) {
  for (const auto& [name, signal] : channels) {
    if (signal->unit != "rad" || signal->grid != "coordinates" || RangeOf(*signal) < kMostTurns_rad) continue;
    found.push_back(WholeFinding(*signal, FindingKind::kUnit, 57.29577951308232, 1, ""));
  }
}

}  // namespace

std::vector<Finding> FindOddScales(const ChannelGroup& group) {
  std::vector<Finding> found;
  if (group.signals.size() < 3) return found;
  // Ranges, and levels of channels that stay far from 0.
  std::vector<double> ranges;
  std::vector<double> levels;
  for (const Signal& signal : group.signals) {
    if (CountFinite(signal.values) < 10) {
      ranges.push_back(0);
      levels.push_back(0);
      continue;
    }
    const auto at = FiniteQuantiles(signal.values, {0.02, 0.5, 0.98});
    ranges.push_back(at[2] - at[0]);
    levels.push_back(at[0] * at[2] > 0 ? at[1] : 0);
  }
  for (std::size_t s = 0; s < ranges.size(); ++s) {
    const auto factor = OddScale(levels, s);
    const auto unit = factor ? factor : OddScale(ranges, s);
    const bool angle = group.signals[s].unit.rfind("rad", 0) == 0;
    const bool possible = unit && group.signals[s].unit != "1" && (angle || *unit > 500 || *unit < 1.0 / 500);
    const bool opposite = std::all_of(levels.begin(), levels.end(), [&](const double& level) {
      return &level == &levels[s] ? level != 0 : level * levels[s] < 0;
    });
    if (!possible && !opposite) continue;
    Finding finding = WholeFinding(group.signals[s], unit ? FindingKind::kUnit : FindingKind::kSign,
                                   unit.value_or(-1), 1, "");
    finding.among = static_cast<int>(ranges.size());
    found.push_back(std::move(finding));
  }
  return found;
}

std::vector<Finding> FindImplausible(const Dataset& dataset, const std::vector<ChannelGroup>& groups) {
  std::map<std::string, OfTrial> trials;
  for (const ChannelGroup& group : groups) {
    for (const Signal& signal : group.signals) trials[signal.trial].emplace(signal.channel, &signal);
  }
  std::vector<Finding> found;
  for (const auto& [name, channels] : trials) {
    for (const std::string& plate : PlateNames(dataset.trials.at(name))) {
      CheckForces(dataset, plate, channels, found);
      CheckPressure(plate, channels, found);
    }
    CheckMarkers(channels, found);
    CheckSpeeds(channels, found);
    CheckAngles(channels, found);
    CheckActivities(channels, found);
    CheckSides(channels, found);
  }
  return found;
}

}  // namespace sinew
