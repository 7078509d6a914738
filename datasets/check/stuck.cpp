#include "datasets/check/stuck.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "datasets/order_statistics.h"

namespace sinew {
namespace {

constexpr std::size_t kStuckShortest = 8;        // [samples] of a run
constexpr std::size_t kStuckMinIncrements = 50;  // that are not 0
constexpr std::size_t kStuckFewLevels = 5;       // values that are repeated, of a signal that is not rounded
constexpr double kStuckRepeats = 0.02;  // share of equal neighbours outside of long runs: it is rounded
constexpr double kStuckStraight = 0.3;  // share of straight pieces: a trapezoid
constexpr double kStuckAbrupt = 0.5;    // of the median increment, at the entry or the exit of a run
constexpr double kStuckJump = 5;        // of the 99th percentile of the increments, at the exit

constexpr std::size_t kStuckFarLonger = 4;  // times all other runs, of a rounded signal
constexpr double kStuckRoundedJump = 5;     // of the median increment, at the exit of such a run
constexpr double kStuckShareOfRange = 0.1;  // and of the range

struct StuckUsual {
  double step = 0;        // median of the increments that are not 0
  double large_step = 0;  // their 99th percentile
  bool rounded = false;
  bool straight = false;
  std::map<double, int> rests;   // runs at each value
  std::size_t longest = 0;       // [samples] of the runs
  std::size_t next_longest = 0;  // of all others
};

// Calls use(i, increment, the one before) for each finite increment, into sample i, but those inside of runs.
template <class Use>
void ForEachOutside(const std::vector<double>& x, const std::vector<Run>& runs, const Use& use) {
  auto run = runs.begin();  // the first that does not end before sample i
  bool in_run = !runs.empty() && runs.front().first == 0;
  for (std::size_t i = 1; i < x.size(); ++i) {
    while (run != runs.end() && run->last < i) ++run;
    const bool was_in_run = in_run;
    in_run = run != runs.end() && run->first <= i;
    const double increment = x[i] - x[i - 1];
    if (!std::isfinite(increment) || (was_in_run && in_run)) continue;
    use(i, increment, i < 2 ? NAN : x[i - 1] - x[i - 2]);
  }
}

StuckUsual Judge(const ChannelGroup& group, const std::vector<std::vector<Run>>& runs) {
  StuckUsual usual;
  double outside = 0;
  double equal = 0;
  std::set<double> repeated;  // some of them
  double bends = 0;
  double straight = 0;
  for (std::size_t s = 0; s < group.signals.size(); ++s) {
    const std::vector<double>& x = group.signals[s].values;
    for (const Run& run : runs[s]) {
      ++usual.rests[run.value];
      usual.next_longest = std::max(usual.next_longest, std::min(usual.longest, run.size()));
      usual.longest = std::max(usual.longest, run.size());
    }
    ForEachOutside(x, runs[s], [&](std::size_t i, double increment, double before) {
      outside += 1;
      equal += increment == 0 ? 1 : 0;
      if (increment == 0 && repeated.size() <= kStuckFewLevels) repeated.insert(x[i]);
      if (!std::isfinite(before)) return;
      bends += 1;
      const double size = std::max(std::abs(increment), std::abs(before));
      straight += std::abs(increment - before) <= 1e-6 * size ? 1 : 0;
    });
  }
  usual.rounded = !(equal < kStuckRepeats * outside) && repeated.size() > kStuckFewLevels;
  usual.straight = straight > kStuckStraight * bends;
  if (outside - equal >= static_cast<double>(kStuckMinIncrements)) {
    const auto sizes = QuantilesOf({0.5, 0.99}, [&](auto add) {
      for (std::size_t s = 0; s < group.signals.size(); ++s) {
        ForEachOutside(group.signals[s].values, runs[s], [&](std::size_t, double increment, double) {
          if (increment != 0) add(std::abs(increment));
        });
      }
    });
    usual.step = sizes[0];
    usual.large_step = sizes[1];
  }
  return usual;
}

bool IsStuck(const Signal& signal, const Run& run, const StuckUsual& usual) {
  const std::vector<double>& x = signal.values;
  const bool entered = run.first > 0 && std::isfinite(x[run.first - 1]);
  const bool left = run.last + 1 < x.size() && std::isfinite(x[run.last + 1]);
  const double exit = left ? std::abs(x[run.last + 1] - x[run.last]) : 0;
  if (usual.rests.at(run.value) >= 3 || (run.value == 0 && usual.rests.at(run.value) >= 2)) return false;
  const auto moves = [&](std::size_t from, std::size_t to) {
    if (to >= x.size()) return false;
    for (std::size_t i = from; i < to; ++i) {
      if (x[i] != x[i + 1]) return true;
    }
    return false;
  };
  const bool moved_before = run.first > kStuckShortest && moves(run.first - kStuckShortest, run.first - 1);
  const bool moves_after = moves(run.last + 1, run.last + 1 + kStuckShortest);
  // It catches up with a jump and goes on.
  if (exit > kStuckJump * usual.large_step && moved_before && moves_after) return true;
  // A rounded sensor rests too, and inputs are held; but a movement begins with small steps, and rests are of
  // all lengths.
  const bool rests = usual.rounded || signal.kind == ChannelKind::kInput;
  if (rests && !usual.straight && run.size() > kStuckFarLonger * usual.next_longest && moved_before &&
      moves_after && exit > kStuckRoundedJump * usual.step && exit > kStuckShareOfRange * RangeOf(signal))
    return true;
  if (rests || usual.straight) return false;
  const double entry = entered ? std::abs(x[run.first] - x[run.first - 1]) : 0;
  return std::max(entry, exit) > kStuckAbrupt * usual.step;
}

}  // namespace

std::vector<Finding> FindStuck(const ChannelGroup& group) {
  std::vector<std::vector<Run>> runs;
  for (const Signal& signal : group.signals) runs.push_back(EqualRuns(signal.values, kStuckShortest));
  const StuckUsual usual = Judge(group, runs);
  if (usual.step == 0) return {};
  std::vector<Finding> found;
  for (std::size_t s = 0; s < group.signals.size(); ++s) {
    const Signal& signal = group.signals[s];
    Finding finding = signal.Found(FindingKind::kStuck);
    for (const Run& run : runs[s]) {
      if (!IsStuck(signal, run, usual)) continue;
      const TimeSpan span = signal.Span(run.first, run.last);
      if (span.to - span.from >= finding.usual) {
        finding.usual = span.to - span.from;
        finding.size = run.value;
      }
      finding.spans.push_back(span);
    }
    if (!finding.spans.empty()) found.push_back(std::move(finding));
  }
  return found;
}

}  // namespace sinew
