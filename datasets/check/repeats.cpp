#include "datasets/check/repeats.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "datasets/check/cycles.h"
#include "datasets/robust.h"

namespace sinew {
namespace {

constexpr std::size_t kRepeatSamples = 400;
constexpr std::size_t kRepeatMostTrials = 24;
constexpr double kRepeatDuration = 0.02;     // largest difference, of the duration
constexpr double kRepeatSame = 0.003;        // median deviation of one shape, of its range
constexpr double kRepeatKept = 0.7;          // share of the samples that tell size and offset
constexpr double kRepeatAway = 0.1;          // deviation of a stretch, of the range
constexpr double kRepeatAwayOfUsual = 10;    // the same of the deviations that 70 % stay below
constexpr double kRepeatMostAway = 0.25;     // share of the samples
constexpr double kRepeatLateOfBefore = 0.2;  // deviation after a shift, of that before
constexpr double kRepeatLongestLag = 0.15;   // of the duration

using RepeatSamples = std::vector<double>;

RepeatSamples Resample(const Signal& signal, double shift) {
  const TimeSpan whole = signal.Whole();
  RepeatSamples samples(kRepeatSamples);
  for (std::size_t i = 0; i < kRepeatSamples; ++i) {
    const double share = (static_cast<double>(i) + 0.5) / kRepeatSamples;
    samples[i] = ValueAt(*signal.time, signal.values, whole.from + share * (whole.to - whole.from) + shift);
  }
  return samples;
}

struct Comparison {
  RepeatSamples deviations;  // [kRepeatSamples] of the measurement from size and offset of the reference
  double middle = INFINITY;  // median of their sizes, of the range
  double kept = INFINITY;    // size that the kept share stays below, of the range
  double gain = 0;
};

// y = offset + gain x, by the samples that fit best.
Comparison CompareRepeats(const RepeatSamples& x, const RepeatSamples& y) {
  Comparison c;
  const auto known = Finite(y);
  if (2 * known.size() < kRepeatSamples) return c;
  const double range = Quantile(known, 0.98) - Quantile(known, 0.02);
  if (!(range > 0)) return c;
  std::vector<bool> kept(kRepeatSamples, true);
  double offset = 0;
  for (int pass = 0; pass < 8; ++pass) {
    double n = 0, mx = 0, my = 0, xx = 0, xy = 0;
    for (std::size_t i = 0; i < kRepeatSamples; ++i) {
      if (!kept[i] || !std::isfinite(x[i] + y[i])) continue;
      n += 1;
      mx += (x[i] - mx) / n;
      my += (y[i] - my) / n;
    }
    for (std::size_t i = 0; i < kRepeatSamples; ++i) {
      if (!kept[i] || !std::isfinite(x[i] + y[i])) continue;
      xx += (x[i] - mx) * (x[i] - mx);
      xy += (x[i] - mx) * (y[i] - my);
    }
    if (!(xx > 0)) return c;
    c.gain = xy / xx;
    offset = my - c.gain * mx;
    c.deviations.assign(kRepeatSamples, NAN);
    RepeatSamples sizes;
    for (std::size_t i = 0; i < kRepeatSamples; ++i) {
      c.deviations[i] = y[i] - offset - c.gain * x[i];
      if (std::isfinite(c.deviations[i])) sizes.push_back(std::abs(c.deviations[i]));
    }
    if (2 * sizes.size() < kRepeatSamples) return c;
    c.middle = Median(sizes) / range;
    const double limit = Quantile(sizes, kRepeatKept);
    c.kept = limit / range;
    for (std::size_t i = 0; i < kRepeatSamples; ++i) kept[i] = std::abs(c.deviations[i]) <= limit;
  }
  for (double& d : c.deviations) d /= range;
  return c;
}

struct Repeats {
  const ChannelGroup& group;
  std::vector<std::size_t> trials;
  std::vector<RepeatSamples> samples;  // of the trials
};

// Trials, of those of one duration, that have one shape: the largest such set, with its member that all
// others resemble.
struct Shape {
  std::size_t reference = 0;
  std::vector<std::size_t> same;
};

Shape CommonShape(const Repeats& r, std::size_t without) {
  Shape best;
  for (std::size_t a = 0; a < r.samples.size(); ++a) {
    if (a == without) continue;
    Shape shape{a, {a}};
    for (std::size_t b = 0; b < r.samples.size(); ++b) {
      if (b == a || b == without) continue;
      const Comparison c = CompareRepeats(r.samples[a], r.samples[b]);
      if (c.middle < kRepeatSame && c.kept < 3 * kRepeatSame) shape.same.push_back(b);
    }
    if (shape.same.size() > best.same.size()) best = shape;
  }
  return best;
}

void FindIn(const Repeats& r, std::size_t t, std::vector<Finding>& found) {
  const Shape shape = CommonShape(r, t);
  if (shape.same.size() < 2) return;
  const Signal& signal = r.group.signals[r.trials[t]];
  const RepeatSamples& reference = r.samples[shape.reference];
  const Comparison here = CompareRepeats(reference, r.samples[t]);
  if (here.deviations.empty()) return;
  const double duration = signal.Whole().to - signal.Whole().from;
  const auto finding = [&](FindingKind kind) {
    Finding f = signal.Found(kind);
    f.among = static_cast<int>(shape.same.size()) + 1;
    f.other = "trial '" + r.group.signals[r.trials[shape.reference]].trial + "'";
    return f;
  };
  if (here.middle < kRepeatSame) {
    Finding away = finding(FindingKind::kDisplaced);
    const double limit = std::max(kRepeatAway, kRepeatAwayOfUsual * here.kept);
    // What any of the other trials does there is usual.
    RepeatSamples usual(kRepeatSamples, 0);
    for (const std::size_t other : shape.same) {
      const Comparison c = CompareRepeats(reference, r.samples[other]);
      for (std::size_t i = 0; i < kRepeatSamples; ++i)
        usual[i] = std::max(usual[i], std::isfinite(c.deviations[i]) ? std::abs(c.deviations[i]) : 0);
    }
    std::size_t count = 0;
    const double step = duration / kRepeatSamples;
    for (std::size_t i = 0; i < kRepeatSamples; ++i) {
      const double size = std::abs(here.deviations[i]);
      if (!(size > limit && size > 3 * usual[i])) continue;
      ++count;
      const double at = signal.Whole().from + static_cast<double>(i) * step;
      if (!away.spans.empty() && at - away.spans.back().to < 1.5 * step) {
        away.spans.back().to = at + step;
      } else {
        away.spans.push_back({at, at + step});
      }
      away.size = std::max(away.size, size * RangeOf(signal));
    }
    away.usual = here.kept * RangeOf(signal);
    if (count > 0 && static_cast<double>(count) < kRepeatMostAway * kRepeatSamples) found.push_back(away);
    return;
  }
  double best = kRepeatLateOfBefore * here.middle;
  double late = 0;
  constexpr int kShifts = 60;
  for (int k = -kShifts; k <= kShifts; ++k) {
    const double shift = kRepeatLongestLag * duration * k / kShifts;
    const Comparison c = CompareRepeats(reference, Resample(signal, shift));
    if (c.middle < best && c.middle < 4 * kRepeatSame && c.gain > 0) {
      best = c.middle;
      late = shift;
    }
  }
  if (late == 0) return;
  Finding lag = finding(FindingKind::kLag);
  lag.whole = true;
  lag.spans = {signal.Whole()};
  lag.size = late;
  found.push_back(lag);
}

}  // namespace

std::vector<Finding> FindOddRepeats(const ChannelGroup& group) {
  Repeats all{group, {}, {}};
  std::vector<double> durations;
  for (const Signal& signal : group.signals) durations.push_back(signal.Whole().to - signal.Whole().from);
  if (group.signals.size() < 3) return {};
  const double usual = Median(durations);
  for (std::size_t s = 0; s < group.signals.size() && all.trials.size() < kRepeatMostTrials; ++s) {
    if (std::abs(durations[s] - usual) > kRepeatDuration * usual || group.signals[s].size() < 30) continue;
    if (group.signals[s].kind != ChannelKind::kInput || !(RangeOf(group.signals[s]) > 0)) continue;
    all.trials.push_back(s);
    all.samples.push_back(Resample(group.signals[s], 0));
  }
  std::vector<Finding> found;
  if (all.trials.size() < 3) return found;
  for (std::size_t t = 0; t < all.trials.size(); ++t) FindIn(all, t, found);
  return found;
}

}  // namespace sinew
