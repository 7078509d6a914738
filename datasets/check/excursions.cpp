#include "datasets/check/excursions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "datasets/order_statistics.h"
#include "datasets/robust.h"

namespace sinew {
namespace {

constexpr std::size_t kExcursionMinIncrements = 100;  // that are not 0: fewer do not tell what is usual
constexpr double kExcursionFaults = 8;       // increments that a fault may have without moving what is usual
constexpr double kExcursionBeyondUsual = 6;  // of the 99th percentile of the increments
constexpr double kExcursionBeyondUsualIfConstant = 3;
constexpr double kExcursionShareOfRange = 0.1;
constexpr double kExcursionBeyondLocal = 5;  // of the 90th percentile of the increments nearby
constexpr std::size_t kExcursionNear = 30;   // [samples] on each side that count as nearby
constexpr double kExcursionReturns = 0.5;    // largest change over the stretch, of the smaller jump
constexpr double kExcursionAlike = 0.3;      // smaller of the two jumps, of the larger one
constexpr double kExcursionLongest = 0.3;    // of the trial
constexpr double kExcursionNoise = 0.5;  // typical increment of a robust deviation: a signal that is noise
constexpr std::size_t kExcursionBurst =
    300;  // [samples] on each side that a spike of such a signal must exceed ...
constexpr double kExcursionBeyondBurst = 2;  // ... by this factor
constexpr std::size_t kExcursionSpike = 3;   // [samples] at most
constexpr std::size_t kExcursionAround = 3;  // increments on each side that tell the local slope

// Increments less the median of their neighbourhood, so that motion is not a jump.
std::vector<double> Unexpected(const std::vector<double>& values) {
  std::vector<double> unexpected = Increments(values);
  std::array<double, kExcursionAround> before;  // the increments in front, which are overwritten
  before.fill(std::numeric_limits<double>::quiet_NaN());
  std::array<double, 2 * kExcursionAround + 1> near{};
  for (std::size_t i = 0; i < unexpected.size(); ++i) {
    const double increment = unexpected[i];
    if (std::isfinite(increment)) {
      std::size_t count = 0;
      for (const double b : before) {
        if (std::isfinite(b)) near[count++] = b;
      }
      for (std::size_t j = i; j <= i + kExcursionAround && j < unexpected.size(); ++j) {
        if (std::isfinite(unexpected[j])) near[count++] = unexpected[j];
      }
      const auto middle = near.begin() + static_cast<std::ptrdiff_t>(count / 2);
      std::nth_element(near.begin(), middle, near.begin() + static_cast<std::ptrdiff_t>(count));
      unexpected[i] = increment - *middle;
    } else {
      unexpected[i] = std::numeric_limits<double>::quiet_NaN();
    }
    before[i % kExcursionAround] = increment;
  }
  return unexpected;
}

struct Excursion {
  std::size_t first;
  std::size_t last;
  double jump;
  bool constant;
};

double MedianOf(const std::vector<double>& values, std::size_t first, std::size_t last) {
  return QuantileOf(0.5, [&](auto add) {
    for (std::size_t i = first; i <= last; ++i) {
      if (std::isfinite(values[i])) add(values[i]);
    }
  });
}

// Steps of one direction right after each other, as a filter makes of a jump, count as one jump.
struct ExcursionJump {
  std::size_t before;  // last sample before
  std::size_t after;   // first sample after
  double net;          // change over all of it
  double largest;      // of its jumps
};

std::vector<ExcursionJump> Jumps(const std::vector<double>& unexpected, double least) {
  std::vector<ExcursionJump> jumps;
  for (std::size_t i = 1; i < unexpected.size(); ++i) {
    if (!(std::abs(unexpected[i]) > least)) continue;
    if (!jumps.empty() && jumps.back().after + 1 == i && jumps.back().net * unexpected[i] > 0) {
      jumps.back().after = i;
      jumps.back().net += unexpected[i];
      jumps.back().largest = std::max(jumps.back().largest, std::abs(jumps.back().net));
    } else {
      jumps.push_back({i - 1, i, unexpected[i], std::abs(unexpected[i])});
    }
  }
  return jumps;
}

// True if the signal is after the second jump where it was before the first one.
bool Returns(const std::vector<double>& x, std::size_t before, std::size_t after, double smaller,
             double typical_step) {
  const double change = MedianOf(x, after, std::min(after + 2, x.size() - 1)) -
                        MedianOf(x, before > 2 ? before - 2 : 0, before);
  return std::abs(change) <
         kExcursionReturns * smaller + typical_step * static_cast<double>(after - before - 1);
}

// Jumps that follow each other within a few samples and leave the signal where it was: one spike. They are
// taken out of the list. Derivatives and filters make such groups of a single wrong sample.
std::vector<Excursion> TakeSpikes(const std::vector<double>& x, std::vector<ExcursionJump>& jumps,
                                  double typical_step) {
  std::vector<Excursion> spikes;
  std::vector<ExcursionJump> others;
  for (std::size_t a = 0; a < jumps.size();) {
    std::size_t b = a;
    double larger = jumps[a].largest;
    while (b + 1 < jumps.size() && jumps[b + 1].before <= jumps[b].after + kExcursionSpike) {
      ++b;
      larger = std::max(larger, jumps[b].largest);
    }
    const std::size_t length = jumps[b].before - jumps[a].after + 1;
    if (b > a && length <= 3 * kExcursionSpike &&
        Returns(x, jumps[a].before, jumps[b].after, larger, typical_step)) {
      bool constant = length > 1;
      for (std::size_t i = jumps[a].after; i < jumps[b].before; ++i) constant = constant && x[i] == x[i + 1];
      spikes.push_back({jumps[a].after, jumps[b].before, larger, constant});
    } else {
      others.insert(others.end(), jumps.begin() + static_cast<std::ptrdiff_t>(a),
                    jumps.begin() + static_cast<std::ptrdiff_t>(b) + 1);
    }
    a = b + 1;
  }
  jumps = std::move(others);
  return spikes;
}

std::vector<Excursion> Excursions(const Signal& signal, std::vector<ExcursionJump> jumps,
                                  double typical_step) {
  const std::vector<double>& x = signal.values;
  std::vector<Excursion> found = TakeSpikes(x, jumps, typical_step);
  const auto longest = static_cast<std::size_t>(kExcursionLongest * static_cast<double>(x.size()));
  for (std::size_t a = 0; a < jumps.size(); ++a) {
    for (std::size_t b = a + 1; b < jumps.size(); ++b) {
      const std::size_t before = jumps[a].before;
      const std::size_t after = jumps[b].after;
      const std::size_t first = jumps[a].after;
      const std::size_t last = jumps[b].before;
      if (last - first + 1 > longest) break;
      const double smaller = std::min(jumps[a].largest, jumps[b].largest);
      const double larger = std::max(jumps[a].largest, jumps[b].largest);
      if (smaller < kExcursionAlike * larger) continue;
      if (jumps[a].net * jumps[b].net > 0) break;
      // Either it comes back to where it was, or it was shifted while it moved on: by as much as it is
      // shifted back.
      const bool shifted = std::abs(jumps[a].net + jumps[b].net) < kExcursionAlike * larger;
      if (!shifted && !Returns(x, before, after, smaller, typical_step)) break;
      // Two single spikes far from each other leave the signal between them where it was.
      const double outside = 0.5 * (MedianOf(x, before > 4 ? before - 4 : 0, before) +
                                    MedianOf(x, after, std::min(after + 4, x.size() - 1)));
      if (!shifted && std::abs(MedianOf(x, first, last) - outside) < kExcursionReturns * smaller) break;
      bool constant = true;
      for (std::size_t i = first; i < last; ++i) constant = constant && x[i] == x[i + 1];
      found.push_back({first, last, larger, constant});
      a = b;
      break;
    }
  }
  return found;
}

// 90th percentile of the unexpected increments around a stretch: bursts of noise have large ones everywhere.
double LocalSize(const std::vector<double>& unexpected, std::size_t first, std::size_t last) {
  std::vector<double> sizes;
  const auto add = [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < std::min(to, unexpected.size()); ++i) {
      if (std::isfinite(unexpected[i])) sizes.push_back(std::abs(unexpected[i]));
    }
  };
  add(first > kExcursionNear + 2 ? first - kExcursionNear - 2 : 0, first > 2 ? first - 2 : 0);
  add(last + 4, last + 4 + kExcursionNear);
  return sizes.empty() ? 0 : Quantile(std::move(sizes), 0.9);
}

// Largest distance from the middle around a stretch of noise, without its next neighbours.
double LargestNearby(const std::vector<double>& x, double middle, const Excursion& e) {
  constexpr std::size_t kSkip = 5;
  double largest = 0;
  const auto add = [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < std::min(to, x.size()); ++i) {
      if (std::isfinite(x[i])) largest = std::max(largest, std::abs(x[i] - middle));
    }
  };
  add(e.first > kExcursionBurst ? e.first - kExcursionBurst : 0, e.first > kSkip ? e.first - kSkip : 0);
  add(e.last + kSkip + 1, e.last + kExcursionBurst);
  return largest;
}

}  // namespace

std::vector<Finding> FindExcursions(const ChannelGroup& group) {
  std::vector<std::vector<double>> unexpected;
  std::size_t moves = 0;
  for (const Signal& signal : group.signals) {
    unexpected.push_back(Unexpected(signal.values));
    moves += static_cast<std::size_t>(std::count_if(unexpected.back().begin(), unexpected.back().end(),
                                                    [](double u) { return std::isfinite(u) && u != 0; }));
  }
  if (moves < kExcursionMinIncrements) return {};
  const auto sizes = [&](auto add) {
    for (const auto& of_signal : unexpected) {
      for (const double u : of_signal) {
        if (std::isfinite(u) && u != 0) add(std::abs(u));
      }
    }
  };
  const auto all = [&](auto add) {
    for (const Signal& signal : group.signals) {
      for (const double v : signal.values) {
        if (std::isfinite(v)) add(v);
      }
    }
  };
  const auto steps = [&](auto add) {
    for (const Signal& signal : group.signals) {
      const std::vector<double>& x = signal.values;
      for (std::size_t i = 1; i < x.size(); ++i) {
        const double d = x[i] - x[i - 1];
        if (std::isfinite(d)) add(std::abs(d));
      }
    }
  };
  // Of a short recording the 99th percentile would be the fault itself.
  const double share = 1 - std::max(0.01, kExcursionFaults / static_cast<double>(moves));
  const double usual = QuantileOf(share, sizes);
  const std::vector<double> levels = QuantilesOf({0.01, 0.5, 0.99}, all);
  const double range = levels[2] - levels[0];
  const double middle = levels[1];
  const double typical_step = QuantileOf(0.5, steps);
  // Raw EMG and the like: from one sample to the next it changes as much as it varies at all.
  const bool is_noise = typical_step > kExcursionNoise * RobustDeviationOf(all);
  const double least_if_constant =
      std::max(kExcursionBeyondUsualIfConstant * usual, kExcursionShareOfRange * range);
  const double least = std::max(kExcursionBeyondUsual * usual, kExcursionShareOfRange * range);
  std::vector<Finding> found;
  for (std::size_t s = 0; s < group.signals.size(); ++s) {
    const Signal& signal = group.signals[s];
    const auto jumps = Jumps(unexpected[s], least_if_constant);
    auto excursions = Excursions(signal, jumps, typical_step);
    for (const FindingKind kind : {FindingKind::kDropout, FindingKind::kSpike, FindingKind::kDisplaced}) {
      Finding finding = signal.Found(kind);
      finding.usual = usual;
      for (const Excursion& e : excursions) {
        const std::size_t length = e.last - e.first + 1;
        const bool dropout = e.constant && (length > kExcursionSpike || signal.values[e.first] == 0);
        if (!dropout && e.jump < least) continue;
        if (e.jump < kExcursionBeyondLocal * LocalSize(unexpected[s], e.first, e.last)) continue;
        if (is_noise && !dropout && length <= 3 * kExcursionSpike) {
          double peak = 0;
          for (std::size_t i = e.first; i <= e.last; ++i)
            peak = std::max(peak, std::abs(signal.values[i] - middle));
          if (peak < kExcursionBeyondBurst * LargestNearby(signal.values, middle, e)) continue;
        }
        const FindingKind which = dropout                         ? FindingKind::kDropout
                                  : length <= 3 * kExcursionSpike ? FindingKind::kSpike
                                                                  : FindingKind::kDisplaced;
        if (which != kind) continue;
        // A controller that differentiates an error answers its first one with a kick: that is a command.
        if (kind == FindingKind::kSpike && signal.kind == ChannelKind::kInput && e.first <= kExcursionSpike)
          continue;
        finding.spans.push_back(signal.Span(e.first, e.last));
        finding.size = std::max(finding.size, e.jump);
      }
      if (!finding.spans.empty()) found.push_back(std::move(finding));
    }
  }
  return found;
}

}  // namespace sinew
