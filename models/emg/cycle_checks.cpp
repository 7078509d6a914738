#include "models/emg/cycle_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/numbers.h"
#include "base/text.h"

namespace sinew {
namespace {

constexpr double kSaturated_s = 20e-3;
constexpr std::size_t kSaturatedSamples = 3;
constexpr std::array<std::pair<MuscleFault, const char*>, 4> kFaults{
    {{MuscleFault::kNoSignal, "without signal"},
     {MuscleFault::kSaturated, "saturated"},
     {MuscleFault::kFrozen, "frozen"},
     {MuscleFault::kGap, "with gaps"}}};

void Add(MuscleCheck& check, const MuscleCycleFault& fault) {
  check.faults.push_back(fault);
  if (!fault.tolerated) check.usable[fault.cycle] = false;
}

// Time in each cycle that intervals [s] take; the intervals are ordered and lie apart.
class Overlap {
 public:
  explicit Overlap(const std::vector<MovementCycle>& cycles) : cycles_(cycles), taken_(cycles.size(), -1) {}

  void Take(double from_s, double to_s) {
    auto cycle = std::lower_bound(cycles_.begin(), cycles_.end(), from_s,
                                  [](const MovementCycle& c, double t) { return c.end_s < t; });
    for (; cycle != cycles_.end() && cycle->begin_s <= to_s; ++cycle) {
      double& taken = taken_[static_cast<std::size_t>(cycle - cycles_.begin())];
      taken = std::max(taken, 0.0) + std::min(cycle->end_s, to_s) - std::max(cycle->begin_s, from_s);
    }
  }

  void Report(MuscleFault fault, double allowed, MuscleCheck& check) const {
    for (std::size_t i = 0; i < cycles_.size(); ++i) {
      if (taken_[i] < 0) continue;
      const double share = std::min(1.0, taken_[i] / cycles_[i].duration_s());
      Add(check, {i, fault, share, share <= allowed && allowed > 0});
    }
  }

 private:
  const std::vector<MovementCycle>& cycles_;
  std::vector<double> taken_;  // -1: none touches it
};

// The envelope within one cycle.
struct Extremes {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
};

double MedianPeak(const std::vector<Extremes>& extremes) {
  std::vector<double> peaks;
  for (const Extremes& e : extremes)
    if (e.high > e.low) peaks.push_back(e.high);
  if (peaks.empty()) return 0;
  const auto middle = peaks.begin() + static_cast<std::ptrdiff_t>(peaks.size() / 2);
  std::nth_element(peaks.begin(), middle, peaks.end());
  return *middle;
}

}  // namespace

Status CheckMuscleCheckSettings(const MuscleCheckSettings& settings) {
  if (!(settings.weakest >= 0 && settings.weakest < 1))
    return Fail("weakest {}: expected a share from 0 to below 1", settings.weakest);
  for (const auto& [name, share] :
       {std::pair{"saturated", settings.saturated}, std::pair{"frozen", settings.frozen}})
    if (!(share >= 0 && share <= 1)) return Fail("{} {}: expected a share from 0 to 1", name, share);
  return {};
}

Result<MuscleCheck> CheckMuscle(const std::vector<double>& time, const std::vector<double>& envelope,
                                const std::vector<MovementCycle>& cycles,
                                const MuscleCheckSettings& settings) {
  SINEW_TRY(CheckMuscleCheckSettings(settings));
  if (time.size() != envelope.size())
    return Fail("{} times for {} values, expected as many", time.size(), envelope.size());
  MuscleCheck check;
  check.usable.assign(cycles.size(), true);
  std::vector<Extremes> extremes(cycles.size());
  Overlap gaps(cycles);
  Extremes all;
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    if (time.empty() || !(cycles[i].begin_s >= time.front() && cycles[i].end_s <= time.back())) {
      return Fail("the cycle from {} to {} s is not covered by the samples", Readable(cycles[i].begin_s, 4),
                  Readable(cycles[i].end_s, 4));
    }
    // With the samples beside its ends, between which values are interpolated.
    auto k = static_cast<std::size_t>(std::upper_bound(time.begin(), time.end(), cycles[i].begin_s) -
                                      time.begin() - 1);
    bool gap = false;
    for (;; ++k) {
      if (std::isfinite(envelope[k])) {
        extremes[i].low = std::min(extremes[i].low, envelope[k]);
        extremes[i].high = std::max(extremes[i].high, envelope[k]);
      } else {
        gap = true;
        const std::size_t before = k > 0 ? k - 1 : k;
        const std::size_t after = std::min(k + 1, time.size() - 1);
        gaps.Take(std::max(cycles[i].begin_s, 0.5 * (time[before] + time[k])),
                  std::min(cycles[i].end_s, 0.5 * (time[k] + time[after])));
      }
      if (time[k] >= cycles[i].end_s) break;
    }
    if (gap && !(extremes[i].high >= extremes[i].low)) extremes[i] = {0, 0};
    all.low = std::min(all.low, extremes[i].low);
    all.high = std::max(all.high, extremes[i].high);
  }
  const double least = settings.weakest * MedianPeak(extremes);
  check.silent = true;
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    const bool none = !(extremes[i].high > extremes[i].low) || extremes[i].high < least;
    if (none) Add(check, {i, MuscleFault::kNoSignal, 1, false});
    check.silent = check.silent && none;
  }
  Overlap saturated(cycles);
  for (std::size_t k = 0; k < time.size() && !check.silent;) {
    std::size_t end = k + 1;
    if (envelope[k] == all.high) {
      while (end < time.size() && envelope[end] == all.high) ++end;
      const double length_s = time[end - 1] - time[k];
      if (end - k >= kSaturatedSamples && length_s >= kSaturated_s * (1 - 1e-9))
        saturated.Take(time[k], time[end - 1]);
    }
    k = end;
  }
  saturated.Report(MuscleFault::kSaturated, settings.saturated, check);
  gaps.Report(MuscleFault::kGap, 0, check);
  return check;
}

void AddRawFaults(const RawEmgFaults& faults, double first_s, double rate_Hz, double reach_s,
                  const std::vector<MovementCycle>& cycles, const MuscleCheckSettings& settings,
                  MuscleCheck& check) {
  const auto add = [&](const std::vector<SampleRun>& runs, MuscleFault fault, double allowed) {
    Overlap overlap(cycles);
    double until_s = -std::numeric_limits<double>::infinity();
    for (const SampleRun& run : runs) {
      // What two faults reach counts once.
      const double from_s = std::max(until_s, first_s + static_cast<double>(run.first) / rate_Hz - reach_s);
      const double to_s = first_s + static_cast<double>(run.first + run.count - 1) / rate_Hz + reach_s;
      if (to_s >= from_s) overlap.Take(from_s, to_s);
      until_s = std::max(until_s, to_s);
    }
    overlap.Report(fault, allowed, check);
  };
  if (faults.silent) {
    check.silent = true;
    check.faults.clear();
    for (std::size_t i = 0; i < cycles.size(); ++i) Add(check, {i, MuscleFault::kNoSignal, 1, false});
    return;
  }
  add(faults.clipped, MuscleFault::kSaturated, settings.saturated);
  add(faults.frozen, MuscleFault::kFrozen, settings.frozen);
  add(faults.gaps, MuscleFault::kGap, 0);
}

std::size_t CountUsable(const MuscleCheck& check) {
  return static_cast<std::size_t>(std::count(check.usable.begin(), check.usable.end(), true));
}

std::vector<std::string> DescribeMuscleCheck(const std::string& muscle,
                                             const std::vector<MovementCycle>& cycles,
                                             const MuscleCheck& check) {
  if (check.silent) return {fmt::format("{}: no signal in any cycle; it is left out.", muscle)};
  std::vector<std::string> out;
  std::vector<std::string> tolerated;
  for (const auto& [kind, words] : kFaults) {
    for (const bool kept : {false, true}) {
      std::vector<bool> has(cycles.size(), false);
      for (const MuscleCycleFault& f : check.faults)
        if (f.fault == kind && check.usable[f.cycle] == kept) has[f.cycle] = true;
      const auto count = std::count(has.begin(), has.end(), true);
      if (count == 0) continue;
      const auto first = static_cast<std::size_t>(std::find(has.begin(), has.end(), true) - has.begin());
      (kept ? tolerated : out)
          .push_back(fmt::format("{} {} (first from {} to {} s)", count, words,
                                 Readable(cycles[first].begin_s, 4), Readable(cycles[first].end_s, 4)));
    }
  }
  std::vector<std::string> sentences;
  if (!out.empty()) {
    sentences.push_back(fmt::format("{}: {} of {} cycles are left out: {}.", muscle,
                                    cycles.size() - CountUsable(check), cycles.size(), Join(out, ", ")));
  }
  if (!tolerated.empty())
    sentences.push_back(fmt::format("{}: used all the same: {}.", muscle, Join(tolerated, ", ")));
  return sentences;
}

}  // namespace sinew
