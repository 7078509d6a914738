#include "datasets/check/clipping.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "datasets/order_statistics.h"
#include "datasets/robust.h"

namespace sinew {
namespace {

constexpr std::size_t kClipShortest = 3;   // [samples] of a run
constexpr std::size_t kClipFewest = 6;     // [samples] at the value, in all runs
constexpr double kClipAbrupt = 3;          // slope at the run's ends, of the smallest increments
constexpr double kClipStraight = 0.3;      // share of straight pieces: a trapezoid
constexpr std::size_t kClipLongRest = 10;  // [samples] of a single rest of a rounded signal
constexpr int kClipLevels = 5;
constexpr double kClipPile = 5;  // samples at the level, of the mean of the next kClipLevels inwards
constexpr std::size_t kClipFewLevels = 5;  // values that are repeated, of a signal that is not rounded
constexpr double kClipVaried = 0.9;        // share of neighbours that differ, of a signal that is not rounded
constexpr double kClipSlopeOfUsual = 0.1;  // and of the median increment

struct ClipShape {
  double quantum = 0;  // 5th percentile of the increments that are not 0
  double step = 0;     // their median
  bool straight = false;
  bool rounded = false;
};

ClipShape ShapeOf(const ChannelGroup& group) {
  double bends = 0;
  double straight = 0;
  double all = 0;
  std::set<double> repeated;  // some of them
  for (const Signal& signal : group.signals) {
    const std::vector<double>& x = signal.values;
    for (std::size_t i = 2; i < x.size(); ++i) {
      const double increment = x[i] - x[i - 1];
      if (!std::isfinite(increment)) continue;
      all += 1;
      if (increment == 0) {
        if (repeated.size() <= kClipFewLevels) repeated.insert(x[i]);
        continue;
      }
      bends += 1;
      straight += std::abs(increment - (x[i - 1] - x[i - 2])) <= 1e-6 * std::abs(increment) ? 1 : 0;
    }
  }
  if (bends < 50) return {0, 0, true, false};
  const bool rounded = bends < kClipVaried * all && repeated.size() > kClipFewLevels;
  const auto sizes = QuantilesOf({0.05, 0.5}, [&](auto add) {
    for (const Signal& signal : group.signals) {
      const std::vector<double>& x = signal.values;
      for (std::size_t i = 2; i < x.size(); ++i) {
        const double increment = x[i] - x[i - 1];
        if (std::isfinite(increment) && increment != 0) add(std::abs(increment));
      }
    }
  });
  // A rounded signal moves by the same number of quanta again and again: straight only where it does not
  // rest.
  return {sizes[0], sizes[1], straight > kClipStraight * bends, rounded};
}

struct ClipLevel {
  std::vector<Run> top;     // reached from below
  std::vector<Run> bottom;  // reached from above
  std::size_t other = 0;    // samples of runs that are passed through
};

std::size_t Samples(const std::vector<Run>& runs) {
  std::size_t samples = 0;
  for (const Run& run : runs) samples += run.size();
  return samples;
}

}  // namespace

std::vector<Finding> FindClipping(const ChannelGroup& group) {
  const ClipShape shape = ShapeOf(group);
  if (shape.straight) return {};
  const double least = std::max(kClipAbrupt * shape.quantum, kClipSlopeOfUsual * shape.step);
  std::vector<Finding> found;
  for (const Signal& signal : group.signals) {
    const std::vector<double>& x = signal.values;
    std::vector<Run> runs = EqualRuns(x, kClipShortest);
    runs.erase(std::remove_if(runs.begin(), runs.end(), [](const Run& run) { return run.value == 0; }),
               runs.end());
    std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) {
      return std::pair(a.value, a.first) < std::pair(b.value, b.first);
    });
    // Of the runs at one value.
    const auto level_of = [&](auto from, auto to) {
      ClipLevel level;
      for (auto at = from; at != to; ++at) {
        const Run& run = *at;
        // At the ends of the record, or of a gap, only one side tells.
        const double before = run.first > 0 ? x[run.first - 1] - run.value : NAN;
        const double behind = run.last + 1 < x.size() ? x[run.last + 1] - run.value : NAN;
        const double in = std::isfinite(before) ? before : behind;
        const double out = std::isfinite(behind) ? behind : before;
        if (!std::isfinite(in)) continue;
        // A rounded signal that comes to rest may leave with a jump: both ends must be abrupt.
        const double slope =
            shape.rounded ? std::min(std::abs(in), std::abs(out)) : std::max(std::abs(in), std::abs(out));
        if (in * out < 0 || slope < least) {
          level.other += run.size();
        } else {
          (in < 0 ? level.top : level.bottom).push_back(run);
        }
      }
      return level;
    };
    // All values in order, where they are asked for at all.
    std::vector<double> in_order;
    const auto sorted = [&]() -> const std::vector<double>& {
      if (in_order.empty()) {
        in_order = Finite(x);
        std::sort(in_order.begin(), in_order.end());
      }
      return in_order;
    };
    const auto is_clipped = [&](const std::vector<Run>& ends, const ClipLevel& level) {
      const std::size_t samples = Samples(ends);
      return samples >= kClipFewest && samples > 4 * level.other;
    };
    // Nothing lies beyond the level from the first run to the last one.
    const auto is_extreme = [&](const std::vector<Run>& ends, bool top) {
      for (std::size_t i = ends.front().first; i <= ends.back().last; ++i) {
        if (top ? x[i] > ends.front().value : x[i] < ends.front().value) return false;
      }
      return true;
    };
    const auto is_abrupt = [&](const Run& run) {
      if (run.first == 0 || run.last + 1 >= x.size()) return false;
      return std::min(std::abs(x[run.first - 1] - run.value), std::abs(x[run.last + 1] - run.value)) >
             shape.step;
    };
    // Samples at the level, against the mean of the next levels inwards: a rounded signal turns within a
    // quantum, and spends some time there.
    const auto piles_up = [&](const std::vector<Run>& ends, bool top) {
      const std::vector<double>& values = sorted();
      auto at = std::equal_range(values.begin(), values.end(), ends.front().value);
      const auto here = static_cast<double>(at.second - at.first);
      double inwards = 0;
      for (int i = 0; i < kClipLevels; ++i) {
        if (top ? at.first == values.begin() : at.second == values.end()) break;
        at = top ? std::equal_range(values.begin(), at.first, *std::prev(at.first))
                 : std::equal_range(at.second, values.end(), *at.second);
        inwards += static_cast<double>(at.second - at.first);
      }
      return here > kClipPile * inwards / kClipLevels;
    };
    std::vector<Finding> here;
    for (auto from = runs.begin(), to = from; from != runs.end(); from = to) {
      const double value = from->value;
      to = std::find_if(from, runs.end(), [&](const Run& run) { return run.value != value; });
      const ClipLevel level = level_of(from, to);
      for (const bool top : {true, false}) {
        const std::vector<Run>& ends = top ? level.top : level.bottom;
        const std::vector<Run>& opposite = top ? level.bottom : level.top;
        if (!is_clipped(ends, level) || !opposite.empty() || !is_extreme(ends, top) || !piles_up(ends, top))
          continue;
        if (shape.rounded && value != (top ? sorted().back() : sorted().front())) continue;
        // A rounded signal may rest at its extreme once, but comes to rest in small steps.
        if (shape.rounded && ends.size() < 2 &&
            !(ends.front().size() >= kClipLongRest && is_abrupt(ends.front())))
          continue;
        Finding finding = signal.Found(FindingKind::kClipping);
        finding.size = value;
        finding.usual = static_cast<double>(Samples(ends)) / static_cast<double>(x.size());
        for (const Run& run : ends) finding.spans.push_back(signal.Span(run.first, run.last));
        here.push_back(std::move(finding));
      }
    }
    if (signal.kind == ChannelKind::kInput && here.size() >= 2) continue;
    // More than two levels are not the ends of a range.
    if (here.size() <= 2) found.insert(found.end(), here.begin(), here.end());
  }
  return found;
}

}  // namespace sinew
