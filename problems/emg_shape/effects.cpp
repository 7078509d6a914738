#include <algorithm>
#include <utility>

#include "problems/emg_shape/parameter_list.h"

namespace sinew {
namespace {

constexpr int kBasis = 9;

void AddWarp(EmgParameterList& to) {
  to.list.BeginEffect(
      "warp_with_speed", Level::kHuman,
      "at higher speeds parts of the cycle take longer and others shorter, in the muscles' activity",
      "the same movement at more speeds");
  // Both at their bounds and four times the reference speed: still one phase after the other.
  constexpr double kMaximum = 0.05;
  for (const auto& [name, along] :
       {std::pair{"warp_sine", EmgAlong::kSine}, std::pair{"warp_cosine", EmgAlong::kCosine}}) {
    const int index = to.AddNumber(BaseParameter(
        name, "1", "amplitude of the phase's warp, per logarithm of the speed", -kMaximum, kMaximum, 0));
    for (std::size_t t = 0; t < to.data.trials.size(); ++t) {
      for (std::size_t m = 0; m < to.muscles(); ++m)
        to.Touch(t, m, {index, EmgTerm::kTiming, along, 0, to.LogSpeed(to.data.trials[t])});
    }
  }
}

void AddFatigue(EmgParameterList& to) {
  to.list.BeginEffect("fatigue", Level::kHuman, "the EMG increases or decreases from cycle to cycle",
                      "a longer recording, or one after a rest");
  for (std::size_t m = 0; m < to.muscles(); ++m) {
    const int index =
        to.AddNumber(BaseParameter(to.data.muscles[m].name + ".fatigue", "1",
                                   "growth of the logarithm of the EMG per cycle", -0.2, 0.2, 0));
    for (std::size_t t = 0; t < to.data.trials.size(); ++t)
      to.Touch(t, m, {index, EmgTerm::kGain, EmgAlong::kCycle, 0, 1});
  }
}

void AddTrialFloors(EmgParameterList& to) {
  std::vector<std::size_t> fitted;
  for (std::size_t t = 0; t < to.data.trials.size(); ++t) {
    if (to.data.trials[t].role == BlockRole::kTrain) fitted.push_back(t);
  }
  if (fitted.size() < 2) return;
  for (const std::size_t t : fitted) {
    const std::string& trial = to.data.trials[t].name;
    to.list.BeginEffect("noise_floor@" + trial, Level::kSensor,
                        "the EMG of one trial has another noise floor", "a rest phase in every trial", "",
                        trial);
    for (std::size_t m = 0; m < to.muscles(); ++m) {
      Parameter p = BaseParameter(to.data.muscles[m].name + ".floor@" + trial, "1",
                                  "floor of the trial beyond that of all", -0.3, 0.3, 0);
      const int index = to.AddNumber(std::move(p));
      to.Touch(t, m, {index, EmgTerm::kOffset, EmgAlong::kOne, 0, 1});
    }
  }
}

void AddCrossTalk(EmgParameterList& to) {
  for (std::size_t m = 0; m < to.muscles(); ++m) {
    to.list.BeginEffect("cross_talk." + to.data.muscles[m].name, Level::kSensor,
                        "the electrode of this muscle records the others too",
                        "a contraction of the other muscles alone");
    const int index =
        to.AddNumber(BaseParameter(to.made.effects.back().name, "1",
                                   "share of the others' EMG, mean of them, in this muscle's", 0, 0.8, 0));
    for (std::size_t t = 0; t < to.data.trials.size(); ++t)
      to.Touch(t, m, {index, EmgTerm::kCrossTalk, EmgAlong::kOne, 0, 1});
  }
}

void AddPorts(EmgParameterList& to) {
  double longest = 0;
  for (const EmgShapeTrial& trial : to.data.trials)
    longest = std::max(longest, trial.time.back() - trial.time.front());
  for (int k = 0; k < kBasis; ++k) to.made.hat_knots.push_back(longest * k / (kBasis - 1));
  for (std::size_t m = 0; m < to.muscles(); ++m) {
    const std::string& muscle = to.data.muscles[m].name;
    to.list.BeginPort(muscle, "1", "EMG that no model of the muscle makes");
    to.list.BeginTerm("time", "s", to.made.hat_knots);
    for (int k = 0; k < kBasis; ++k) {
      const int index = to.AddKnot(BaseParameter(fmt::format("{}(time).{}", muscle, k + 1), "1",
                                                 "EMG of an unknown source", -1, 1, 0));
      for (std::size_t t = 0; t < to.data.trials.size(); ++t)
        to.Touch(t, m, {index, EmgTerm::kOffset, EmgAlong::kBasis, k, 1});
    }
  }
}

}  // namespace

void AddEffects(EmgParameterList& to) {
  if (to.Laws() && !to.settings.amplitude_law) {
    to.list.BeginEffect("amplitude_with_speed", Level::kHuman,
                        "muscles are more or less active at higher speeds",
                        "the same movement at more speeds");
    for (std::size_t m = 0; m < to.muscles(); ++m) AddExponent(to, m, true);
  }
  if (to.Laws() && !to.settings.lead_law) {
    to.list.BeginEffect("phase_shift_with_speed", Level::kHuman,
                        "bursts come earlier or later in the cycle at higher speeds",
                        "the same movement at more speeds");
    AddLead(to, true);
  }
  if (to.Laws()) AddWarp(to);
  AddFatigue(to);
  AddTrialFloors(to);
  if (to.muscles() > 1) AddCrossTalk(to);
  AddPorts(to);
}

}  // namespace sinew
