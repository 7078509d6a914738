#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "problems/emg_shape/parameter_list.h"

namespace sinew {
namespace {

constexpr double kMinOwn = 0.3;  // of a muscle's scatter of timing, at least, is its own

// Gain and timing; -1 where the scatter is 0.
std::array<int, 2> AddScatter(EmgParameterList& to, const std::string& of, const std::string& whose,
                              const std::string& trial, double gain_scatter, double timing_scatter) {
  std::array<int, 2> added{-1, -1};
  if (gain_scatter > 0) {
    Parameter gain =
        BaseParameter("gain" + of, "1", "logarithm of " + whose + " gain", -kMaxGain, kMaxGain, 0);
    gain.trial = trial;
    added[0] = to.AddNuisance(std::move(gain), gain_scatter);
  }
  if (timing_scatter > 0) {
    Parameter timing =
        BaseParameter("timing" + of, "1", "share of the cycle by which " + whose + " EMG is early",
                      -kMaxTiming, kMaxTiming, 0);
    timing.trial = trial;
    added[1] = to.AddNuisance(std::move(timing), timing_scatter);
  }
  return added;
}

// @param added gain and timing of the muscle's own; -1: none
void TouchWindow(EmgParameterList& to, std::size_t t, std::size_t m, std::size_t window,
                 const std::array<int, 2>& added) {
  const int which = static_cast<int>(window);
  if (added[0] >= 0) to.Touch(t, m, {added[0], EmgTerm::kGain, EmgAlong::kWindow, which, 1});
  if (added[1] >= 0) to.Touch(t, m, {added[1], EmgTerm::kTiming, EmgAlong::kWindow, which, 1});
}

// What all bursts of a cycle have in common, and what each has of its own.
void AddBursts(EmgParameterList& to, std::size_t t, std::size_t m) {
  const EmgShapeTrial& trial = to.data.trials[t];
  const EmgMuscle& muscle = to.data.muscles[m];
  // Of timing, a part may be that of all muscles.
  const double shared = to.muscles() < 2 ? 0 : to.data.shared_timing;
  const auto beyond = [&](double scatter) {
    return std::max(std::sqrt(std::max(scatter * scatter - shared * shared, 0.0)), kMinOwn * scatter);
  };
  const EmgScatterFactors& factor = trial.scatter[m];
  const bool correlated = muscle.timing.together > 0;
  const double common = correlated ? beyond(muscle.timing.together) : 0;
  const double own = correlated ? muscle.timing.own() : beyond(muscle.timing.total);
  int cycle = 0;
  int number = 0;
  std::array<int, 2> together{-1, -1};
  for (std::size_t w = 0; w < trial.windows[m].size(); ++w) {
    const EmgWindow& window = trial.windows[m][w];
    if (!window.fitted) continue;
    if (number == 0 || window.cycle != cycle) {
      number = 0;
      cycle = window.cycle;
      const std::string of = fmt::format("@{}.{}.{}", trial.name, cycle + 1, muscle.name);
      together = AddScatter(to, of, "one cycle's", trial.name, factor.gain * muscle.gain.together,
                            factor.timing * common);
    }
    ++number;
    TouchWindow(to, t, m, w, together);
    const std::string of = fmt::format("@{}.{}.{}.{}", trial.name, cycle + 1, muscle.name, number);
    TouchWindow(
        to, t, m, w,
        AddScatter(to, of, "one burst's", trial.name, factor.gain * muscle.gain.own(), factor.timing * own));
  }
}

// A person who is early is so with all muscles.
void AddSharedTimings(EmgParameterList& to, std::size_t t) {
  const EmgShapeTrial& trial = to.data.trials[t];
  if (!(to.data.shared_timing > 0) || to.muscles() < 2) return;
  double factor = 0;
  for (const EmgScatterFactors& of : trial.scatter) factor += of.timing / static_cast<double>(to.muscles());
  std::map<int, int> of_cycle;
  for (std::size_t m = 0; m < to.muscles(); ++m) {
    for (std::size_t w = 0; w < trial.windows[m].size(); ++w) {
      const EmgWindow& window = trial.windows[m][w];
      if (!window.fitted) continue;
      const auto [found, first] = of_cycle.try_emplace(window.cycle, -1);
      if (first) {
        Parameter p = BaseParameter(fmt::format("timing@{}.{}", trial.name, window.cycle + 1), "1",
                                    "share of the cycle by which all muscles are early in it", -kMaxTiming,
                                    kMaxTiming, 0);
        p.trial = trial.name;
        found->second = to.AddNuisance(std::move(p), factor * to.data.shared_timing);
      }
      to.Touch(t, m, {found->second, EmgTerm::kTiming, EmgAlong::kAllMuscles, static_cast<int>(w), 1});
    }
  }
}

}  // namespace

void AddCycles(EmgParameterList& to) {
  for (std::size_t t = 0; t < to.data.trials.size(); ++t) {
    AddSharedTimings(to, t);
    for (std::size_t m = 0; m < to.muscles(); ++m) AddBursts(to, t, m);
  }
}

}  // namespace sinew
