#include "datasets/check/drift.h"

#include <algorithm>
#include <cmath>

#include "datasets/order_statistics.h"
#include "datasets/robust.h"

namespace sinew {
namespace {

constexpr std::size_t kDriftPhases = 40;
constexpr std::size_t kDriftFewest = 6;  // levels
constexpr double kDriftShareOfRange = 0.05;
constexpr double kDriftDeviations = 4;     // of the levels about the line
constexpr double kDriftKendall = 4;        // standard deviations of Kendall's statistic, of many levels
constexpr double kDriftUnloaded = 0.1;     // of the range of a plate's force
constexpr double kDriftShortest_s = 0.05;  // of an unloaded stretch
constexpr double kDriftPiece_s = 0.25;     // longest: longer ones give several levels
constexpr std::size_t kDriftMost = 2000;   // levels: of more the medians of neighbours, as pairs are compared

struct Levels {
  std::vector<double> time;
  std::vector<double> level;
};

// Of a cyclic trial: at the phases that scatter least.
Levels OfCycles(const Signal& signal, const Cycles& cycles) {
  const int count = cycles.count();
  std::vector<std::vector<double>> phases(kDriftPhases);
  for (int k = 0; k < count; ++k) {
    const double from = cycles.starts[static_cast<std::size_t>(k)];
    const double length = cycles.starts[static_cast<std::size_t>(k) + 1] - from;
    for (std::size_t i = 0; i < kDriftPhases; ++i)
      phases[i].push_back(ValueAt(*signal.time, signal.values,
                                  from + length * (static_cast<double>(i) + 0.5) / kDriftPhases));
  }
  // Differences between neighbouring cycles: a drift is small in them.
  std::vector<std::pair<double, std::size_t>> scatter;
  for (std::size_t i = 0; i < kDriftPhases; ++i) {
    const auto steps = Finite(Increments(phases[i]));
    if (2 * steps.size() < phases[i].size()) continue;
    scatter.emplace_back(RobustDeviation(steps), i);
  }
  Levels levels;
  if (scatter.size() < kDriftPhases / 2) return levels;
  std::sort(scatter.begin(), scatter.end());
  scatter.resize(kDriftPhases / 4);
  std::vector<double> usual;
  for (const auto& [unused, i] : scatter) usual.push_back(Median(Finite(phases[i])));
  for (int k = 0; k < count; ++k) {
    std::vector<double> at;
    for (std::size_t j = 0; j < scatter.size(); ++j)
      at.push_back(phases[scatter[j].second][static_cast<std::size_t>(k)] - usual[j]);
    at = Finite(at);
    if (at.empty()) continue;
    levels.time.push_back(
        0.5 * (cycles.starts[static_cast<std::size_t>(k)] + cycles.starts[static_cast<std::size_t>(k) + 1]));
    levels.level.push_back(Median(at));
  }
  return levels;
}

// Of a plate: medians of its unloaded stretches.
Levels OfUnloaded(const Signal& signal, double low, double high) {
  Levels levels;
  const auto& t = *signal.time;
  std::vector<double> piece;
  std::size_t first = 0;
  for (std::size_t i = 0; i <= signal.size(); ++i) {
    const bool unloaded = i < signal.size() && signal.values[i] < low + kDriftUnloaded * (high - low);
    const bool ends = !unloaded || (!piece.empty() && t[i] - t[first] > kDriftPiece_s);
    if (ends && !piece.empty()) {
      if (t[i - 1] - t[first] > kDriftShortest_s) {
        levels.time.push_back(0.5 * (t[first] + t[i - 1]));
        levels.level.push_back(Median(piece));
      }
      piece.clear();
    }
    if (!unloaded) continue;
    if (piece.empty()) first = i;
    piece.push_back(signal.values[i]);
  }
  return levels;
}

// At most kDriftMost: medians of as many neighbours each.
Levels Condensed(Levels levels) {
  const std::size_t n = levels.time.size();
  if (n <= kDriftMost) return levels;
  const std::size_t width = (n + kDriftMost - 1) / kDriftMost;
  Levels condensed;
  for (std::size_t from = 0; from < n; from += width) {
    const auto first = static_cast<std::ptrdiff_t>(from);
    const auto end = static_cast<std::ptrdiff_t>(std::min(n, from + width));
    const auto middle = [&](const std::vector<double>& of) {
      return Median({of.begin() + first, of.begin() + end});
    };
    condensed.time.push_back(middle(levels.time));
    condensed.level.push_back(middle(levels.level));
  }
  return condensed;
}

}  // namespace

std::vector<Finding> FindDrift(const Signal& signal, const Cycles& cycles) {
  const bool is_load = signal.unit == "N" || signal.unit == "N*m" || signal.unit == "V";
  if (!is_load || signal.kind != ChannelKind::kMeasured || CountFinite(signal.values) < 100) return {};
  const auto ends = FiniteQuantiles(signal.values, {0.01, 0.99});
  const double low = ends[0];
  const double high = ends[1];
  const bool plate = signal.channel.find("_force_y") != std::string::npos;
  // The free moment of a plate is known only where it is loaded.
  if (signal.channel.find("_moment_") != std::string::npos) return {};
  const Levels levels = cycles.count() > 0 ? OfCycles(signal, cycles)
                        : plate            ? Condensed(OfUnloaded(signal, low, high))
                                           : Levels{};
  const std::size_t n = levels.time.size();
  if (n < kDriftFewest) return {};
  std::vector<double> slopes;
  double order = 0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 1; j < n; ++j) {
      slopes.push_back((levels.level[j] - levels.level[i]) / (levels.time[j] - levels.time[i]));
      order += slopes.back() > 0 ? 1 : slopes.back() < 0 ? -1 : 0;
    }
  }
  const double slope = Median(slopes);
  std::vector<double> left;
  for (std::size_t i = 0; i < n; ++i) left.push_back(levels.level[i] - slope * levels.time[i]);
  const double change = slope * (levels.time.back() - levels.time.front());
  const double scatter = RobustDeviation(left);
  const auto count = static_cast<double>(n);
  const double kendall = std::abs(order) / std::sqrt(count * (count - 1) * (2 * count + 5) / 18);
  // Of few levels Kendall's statistic cannot reach four: all must be in order.
  const double most = 0.9 * std::sqrt(count * (count - 1) * 4.5 / (2 * count + 5));
  if (kendall < std::min(kDriftKendall, most)) return {};
  if (std::abs(change) < std::max(kDriftShareOfRange * (high - low), kDriftDeviations * scatter)) return {};
  Finding finding = signal.Found(FindingKind::kDrift);
  finding.whole = true;
  finding.spans = {signal.Whole()};
  finding.size = change;
  finding.usual = scatter;
  return {finding};
}

}  // namespace sinew
