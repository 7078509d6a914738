#include "models/emg/cycle_alignment.h"

#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

constexpr double kRegular = 0.1;  // of the median interval
constexpr double kNear = 0.1;     // of the cycle
constexpr double kComparable = 0.4;
constexpr std::size_t kMinimum = 3;  // beginnings and reversals: fewer have no rule

using Points = std::vector<TurningPoint>;

Points OfKind(const Points& points, bool highest) {
  Points kind;
  std::copy_if(points.begin(), points.end(), std::back_inserter(kind),
               [highest](const TurningPoint& p) { return p.highest == highest; });
  return kind;
}

// The same point as the small turns have it: times of points from one list keep their order.
TurningPoint AmongSmall(const TurningPoint& point, const Points& small) {
  const auto found = std::lower_bound(small.begin(), small.end(), point.sample,
                                      [](const TurningPoint& p, std::size_t k) { return p.sample < k; });
  return found != small.end() && found->sample == point.sample ? *found : point;
}

double MedianInterval(const Points& points) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < points.size(); ++i)
    intervals.push_back(points[i].time_s - points[i - 1].time_s);
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

std::size_t Irregular(const Points& points) {
  if (points.size() < kMinimum) return 0;
  const double median = MedianInterval(points);
  std::size_t count = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double interval = points[i].time_s - points[i - 1].time_s;
    count += std::abs(interval - median) > kRegular * median ? 1 : 0;
  }
  return count;
}

// The mean of the phases that have most others near them. @param phases not empty
double CommonPhase(std::vector<double> phases) {
  std::sort(phases.begin(), phases.end());
  std::size_t best_from = 0;
  std::size_t best_to = 0;
  std::size_t from = 0;
  for (std::size_t to = 0; to < phases.size(); ++to) {
    while (phases[to] - phases[from] > kNear) ++from;
    if (to - from > best_to - best_from) {
      best_from = from;
      best_to = to;
    }
  }
  double sum = 0;
  for (std::size_t i = best_from; i <= best_to; ++i) sum += phases[i];
  return sum / static_cast<double>(best_to - best_from + 1);
}

void Align(const Points& beginnings, const Points& reversals, const Points& small, bool from_highest,
           double range, AlignedPoints& aligned) {
  std::vector<double> phases;
  for (std::size_t b = 0, r = 0; b < beginnings.size(); ++b) {
    while (r < reversals.size() && reversals[r].time_s < beginnings[b].time_s) ++r;
    if (r == 0 || r == reversals.size()) continue;
    const double from_s = reversals[r - 1].time_s;
    phases.push_back((beginnings[b].time_s - from_s) / (reversals[r].time_s - from_s));
  }
  if (phases.empty()) return;
  aligned.points.clear();
  aligned.phase = CommonPhase(std::move(phases));
  const double interval_s = MedianInterval(reversals);
  const Points candidates = OfKind(small, from_highest);
  std::size_t next = 0;  // candidate
  std::size_t own = 0;   // beginning
  // Windows from each reversal to the next, and one as long as most before the first and behind the last.
  for (std::size_t r = 0; r <= reversals.size(); ++r) {
    const bool first = r == 0;
    const bool last = r == reversals.size();
    const double from_s = first ? reversals[0].time_s - interval_s : reversals[r - 1].time_s;
    const double length_s = first || last ? interval_s : reversals[r].time_s - from_s;
    const double expected_s = from_s + aligned.phase * length_s;
    const TurningPoint* old = nullptr;
    for (; own < beginnings.size() && (last || beginnings[own].time_s < reversals[r].time_s); ++own)
      old = &beginnings[own];
    const TurningPoint* best = nullptr;
    // Never beyond the reversals, at whichever phase.
    const double earliest_s = std::max(expected_s - kNear * length_s, from_s);
    const double latest_s = std::min(expected_s + kNear * length_s, from_s + length_s);
    while (next < candidates.size() && candidates[next].time_s <= earliest_s) ++next;
    for (std::size_t k = next; k < candidates.size() && candidates[k].time_s < latest_s; ++k) {
      const bool better = best == nullptr || (from_highest ? candidates[k].angle > best->angle
                                                           : candidates[k].angle < best->angle);
      if (better) best = &candidates[k];
    }
    if (best != nullptr && old != nullptr && std::abs(best->angle - old->angle) > kComparable * range)
      best = nullptr;
    if (best != nullptr) {
      if (old != nullptr && old->sample != best->sample) ++aligned.moved;
      aligned.points.push_back(*best);
    } else if (old != nullptr && !first && !last) {
      aligned.points.push_back(AmongSmall(*old, small));
    }
    if (!last) aligned.points.push_back(AmongSmall(reversals[r], small));
  }
}

}  // namespace

AlignedPoints AlignBeginnings(const Points& points, const Points& small, bool from_highest, double range) {
  const Points beginnings = OfKind(points, from_highest);
  const Points reversals = OfKind(points, !from_highest);
  AlignedPoints aligned;
  aligned.points = points;
  aligned.irregular_reversals = Irregular(reversals);
  if (beginnings.size() >= kMinimum && reversals.size() >= kMinimum &&
      Irregular(beginnings) > aligned.irregular_reversals)
    Align(beginnings, reversals, small, from_highest, range, aligned);
  aligned.irregular_beginnings = Irregular(OfKind(aligned.points, from_highest));
  return aligned;
}

}  // namespace sinew
