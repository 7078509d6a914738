#include "problems/emg_shape/learning/bursts.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace sinew {
namespace {

constexpr double kBetweenBursts = 0.03;  // of the curve's range, by which a cut lies below both bursts
constexpr double kHalfWidth = 1.1774;    // of a bell curve at half of its height, in standard deviations
constexpr double kFlat = 12;             // least steepness [1 / cycle]
constexpr double kSteep = 400;           // and most
constexpr double kTail = 6;  // reach times steepness: a quarter of a percent is left of the other burst

// Minima on the circle, each at least `depth` below the maxima on both sides; increasing.
std::vector<int> Valleys(const Vector& curve, double depth) {
  const auto n = static_cast<int>(curve.size());
  Eigen::Index lowest = 0;
  curve.minCoeff(&lowest);
  std::vector<int> valleys{static_cast<int>(lowest)};
  double peak = curve[lowest];
  int candidate = -1;  // lowest point since the peak
  for (int i = 1; i < n; ++i) {
    const int at = (static_cast<int>(lowest) + i) % n;
    const double value = curve[at];
    if (candidate < 0) {
      peak = std::max(peak, value);
      if (peak - curve[valleys.back()] > depth && peak - value > depth) candidate = at;
      continue;
    }
    if (value < curve[candidate]) candidate = at;
    if (value - curve[candidate] > depth) {
      valleys.push_back(candidate);
      candidate = -1;
      peak = value;
    }
  }
  std::sort(valleys.begin(), valleys.end());
  return valleys;
}

double LogisticOf(double x) {
  return 1 / (1 + std::exp(-x));
}

// How far from its peak [samples] a burst has half of its height above the valley, on the way to that valley.
double HalfWay(const Vector& curve, int peak, int valley) {
  const auto n = static_cast<int>(curve.size());
  const auto at = [&](int i) { return curve[((i % n) + n) % n]; };
  const int step = valley > peak ? 1 : -1;
  const double half = 0.5 * (at(peak) + at(valley));
  int i = peak;
  while (i != valley && at(i) > half) i += step;
  return std::max(1, std::abs(i - peak));
}

// Two bell curves of widths s1, s2 with their peaks at p1 < c < p2 have the logarithm of their ratio rise by
// (c - p1) / s1^2 + (p2 - c) / s2^2 at c.
BurstCut CutAt(const Vector& curve, int before, int valley, int after) {
  const auto n = static_cast<int>(curve.size());
  const auto at = [&](int i) { return curve[((i % n) + n) % n]; };
  int first = before;
  int last = valley;
  for (int i = before; i < valley; ++i) first = at(i) > at(first) ? i : first;
  for (int i = valley; i < after; ++i) last = at(i) > at(last) ? i : last;
  const double left = HalfWay(curve, first, valley) / kHalfWidth;
  const double right = HalfWay(curve, last, valley) / kHalfWidth;
  BurstCut cut;
  cut.phase = static_cast<double>(valley) / n;
  cut.steepness =
      std::clamp(n * ((valley - first) / (left * left) + (last - valley) / (right * right)), kFlat, kSteep);
  cut.reach = std::min(kTail / cut.steepness, 0.5 * std::min(valley - before, after - valley) / n);
  return cut;
}

}  // namespace

BurstCut::Share BurstCut::Later(double since) const {
  if (since <= -reach) return {0, 0};
  if (since >= reach) return {1, 0};
  const double end = LogisticOf(-steepness * reach);
  const double share = LogisticOf(steepness * since);
  return {(share - end) / (1 - 2 * end), steepness * share * (1 - share) / (1 - 2 * end)};
}

int BurstPattern::BurstAt(int cycle, double phase) const {
  if (cuts.empty()) return cycle;
  const auto past = std::upper_bound(cuts.begin(), cuts.end(), phase,
                                     [](double of, const BurstCut& cut) { return of < cut.phase; }) -
                    cuts.begin();
  return cycle * count() + static_cast<int>(past);
}

int BurstPattern::IndexOf(int burst) const {
  return ((burst % count()) + count()) % count();
}

int BurstPattern::CycleOf(int burst) const {
  const int since = burst - main + count() - 1 - std::min(after, count() - 1);
  return since >= 0 ? since / count() : -((count() - 1 - since) / count());
}

BurstPattern FindBursts(const Vector& curve) {
  BurstPattern pattern;
  const double depth = kBetweenBursts * (curve.maxCoeff() - curve.minCoeff());
  const auto n = static_cast<int>(curve.size());
  const std::vector<int> valleys = Valleys(curve, depth);
  for (std::size_t i = 0; i < valleys.size(); ++i) {
    const int before = i > 0 ? valleys[i - 1] : valleys.back() - n;
    const int after = i + 1 < valleys.size() ? valleys[i + 1] : valleys.front() + n;
    pattern.cuts.push_back(CutAt(curve, before, valleys[i], after));
  }
  Eigen::Index highest = 0;
  curve.maxCoeff(&highest);
  pattern.main =
      pattern.BurstAt(0, static_cast<double>(highest) / static_cast<double>(curve.size())) % pattern.count();
  return pattern;
}

}  // namespace sinew
