#include "problems/emg_shape/emg_shape_parameters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/constants.h"

namespace sinew {
namespace {

constexpr double kMuscleLead = 0.03;  // [s]
constexpr double kFloor = 0.02;
constexpr double kMostTiming = 0.25;  // [cycle]; further would be another burst
constexpr double kMostGain = 2;       // of the logarithm
constexpr double kLeastOwn = 0.3;     // of a muscle's scatter of timing, at least, is its own
constexpr int kHats = 9;
constexpr const char* kSource = "thesis ch. 6; docs/decisions/emg_shape_model.md";

class Builder {
 public:
  Builder(const EmgShapeSettings& settings, const EmgShapeData& data) : settings_(settings), data_(data) {
    list_.columns.resize(data.layout.size());
  }

  EmgShapeParameters Take() {
    for (auto& columns : list_.columns) {
      std::stable_sort(columns.begin(), columns.end(),
                       [](const EmgColumn& a, const EmgColumn& b) { return a.parameter < b.parameter; });
    }
    return std::move(list_);
  }

  void AddModel() {
    for (std::size_t m = 0; m < muscles(); ++m) AddShape(m);
    if (Laws() && settings_.amplitude_law) {
      for (std::size_t m = 0; m < muscles(); ++m) AddExponent(m, "");
    }
    if (Laws() && settings_.lead_law) AddLead("");
    if (settings_.cycle_scatter) {
      for (std::size_t m = 0; m < muscles(); ++m) AddFloor(m);
    }
    AddSpeeds();
    if (settings_.cycle_scatter) AddCycles();
  }

  void AddEffects() {
    if (Laws() && !settings_.amplitude_law) {
      Name("amplitude_with_speed", Level::kHuman, "muscles are more or less active at higher speeds",
           "the same movement at more speeds");
      for (std::size_t m = 0; m < muscles(); ++m) AddExponent(m, list_.effects.back().name);
    }
    if (Laws() && !settings_.lead_law) {
      Name("phase_shift_with_speed", Level::kHuman,
           "bursts come earlier or later in the cycle at higher speeds", "the same movement at more speeds");
      AddLead(list_.effects.back().name);
    }
    if (Laws()) AddWarp();
    AddFatigue();
    AddTrialFloors();
    if (muscles() > 1) AddCrossTalk();
    AddPorts();
  }

 private:
  [[nodiscard]] std::size_t muscles() const { return data_.muscles.size(); }
  // With one speed there is nothing that changes with it; a model that was fitted elsewhere has its laws.
  [[nodiscard]] bool Laws() const { return data_.trained_speeds() != 1; }
  [[nodiscard]] double LogSpeed(const EmgShapeTrial& trial) const {
    return std::log(trial.speed / data_.reference.speed);
  }
  [[nodiscard]] double Rhythm(const EmgShapeTrial& trial) const {
    return 1 / trial.period - 1 / data_.reference.period;
  }

  void Name(const std::string& name, Level level, const std::string& says, const std::string& exposed_by) {
    list_.effects.push_back({name, level, says, exposed_by, {}});
  }

  int Add(Parameter p, const std::string& effect) {
    p.source = kSource;
    const int index = static_cast<int>(list_.parameters.size());
    if (!effect.empty()) {
      p.kind = ParameterKind::kEffect;
      p.effect = effect;
      p.null_value = p.start;
      p.prior.reset();
      if (!list_.effects.empty() && list_.effects.back().name == effect)
        list_.effects.back().parameters.push_back(index);
    }
    list_.parameters.push_back(std::move(p));
    return index;
  }

  int AddNuisance(Parameter p, double deviation) {
    p.kind = ParameterKind::kNuisance;
    if (deviation > 0) p.prior = GaussianPrior{p.start, deviation};
    return Add(std::move(p), "");
  }

  // Touches all samples of a muscle's block in a trial.
  void Touch(std::size_t trial, std::size_t muscle, EmgColumn column) {
    const auto block = static_cast<std::size_t>(data_.trials[trial].first_block) + muscle;
    list_.columns[block].push_back(column);
  }

  void AddShape(std::size_t m) {
    const EmgMuscle& muscle = data_.muscles[m];
    // An envelope has no negative values, its spline may dip a little.
    const double most = std::max(2.0, 2 * muscle.shape.maxCoeff());
    for (int j = 0; j < settings_.knots; ++j) {
      Parameter p =
          BaseParameter(fmt::format("{}.shape_{:02}", muscle.name, j + 1), "1",
                        "control point of the EMG's shape over a cycle", -most / 4, most, muscle.shape[j]);
      const int index = AddNuisance(std::move(p), 0);
      for (std::size_t t = 0; t < data_.trials.size(); ++t)
        Touch(t, m, {index, EmgTerm::kShape, EmgAlong::kOne, j, 1});
    }
  }

  void AddExponent(std::size_t m, const std::string& effect) {
    const int index =
        Add(BaseParameter(data_.muscles[m].name + ".amplitude_exponent", "1",
                          "exponent of the speed to which the EMG's size is proportional", -4, 6, 0),
            effect);
    for (std::size_t t = 0; t < data_.trials.size(); ++t)
      Touch(t, m, {index, EmgTerm::kGain, EmgAlong::kOne, 0, LogSpeed(data_.trials[t])});
  }

  void AddLead(const std::string& effect) {
    const int shared =
        Add(BaseParameter("lead", "s", "by which bursts come before the movement, mean of all muscles", -0.5,
                          0.5, 0),
            effect);
    const auto touch = [&](std::size_t m, int index, double factor) {
      for (std::size_t t = 0; t < data_.trials.size(); ++t)
        Touch(t, m, {index, EmgTerm::kTiming, EmgAlong::kOne, 0, factor * Rhythm(data_.trials[t])});
    };
    for (std::size_t m = 0; m < muscles(); ++m) touch(m, shared, 1);
    if (!settings_.timing_per_muscle || !effect.empty()) return;
    // Their sum is 0, or they and the shared one could not be told apart: the last one makes up for the
    // others.
    for (std::size_t m = 0; m + 1 < muscles(); ++m) {
      Parameter p = BaseParameter(data_.muscles[m].name + ".lead", "s", "lead beyond the mean of all muscles",
                                  -0.2, 0.2, 0);
      p.prior = GaussianPrior{0, kMuscleLead};
      const int own = Add(std::move(p), "");
      touch(m, own, 1);
      touch(muscles() - 1, own, -1);
    }
  }

  void AddFloor(std::size_t m) {
    Parameter p = BaseParameter(data_.muscles[m].name + ".floor", "1",
                                "of the EMG, that no gain of a cycle or a speed changes", -0.1, 0.4, 0);
    p.prior = GaussianPrior{0, kFloor};
    const int index = Add(std::move(p), "");
    for (std::size_t t = 0; t < data_.trials.size(); ++t)
      Touch(t, m, {index, EmgTerm::kOffset, EmgAlong::kOne, 0, 1});
  }

  // Where the shape lies in the cycle. A spline follows a shift of itself nearly, but the noise of valleys is
  // less than what is missing: the shape would stay where it began, at the reference speed, and that speed
  // alone would be on time.
  void AddPhase(std::size_t m) {
    const int index =
        AddNuisance(BaseParameter(data_.muscles[m].name + ".phase", "1",
                                  "share of the cycle by which the shape is early at all speeds",
                                  -kMostTiming, kMostTiming, 0),
                    0);
    for (std::size_t t = 0; t < data_.trials.size(); ++t)
      Touch(t, m, {index, EmgTerm::kTiming, EmgAlong::kOne, 0, 1});
  }

  // What people do at a speed that no law says. A speed that was not measured has none of its own.
  void AddSpeeds() {
    if (data_.trained_speeds() == 1) return;
    for (std::size_t m = 0; m < muscles(); ++m) AddPhase(m);
    for (std::size_t s = 0; s < data_.speeds.size(); ++s) {
      // Where nothing is fitted, they may come from a run that was.
      if (!data_.speeds[s].trained && data_.trained_speeds() > 0) continue;
      const std::string at = "@" + data_.speeds[s].label;
      const int shared = AddNuisance(
          BaseParameter("timing" + at, "1", "share of the cycle by which bursts are early at this speed",
                        -kMostTiming, kMostTiming, 0),
          kSpeedTiming);
      for (std::size_t m = 0; m < muscles(); ++m) {
        const std::string& name = data_.muscles[m].name;
        std::vector<std::pair<int, EmgTerm>> own{{shared, EmgTerm::kTiming}};
        if (settings_.timing_per_muscle) {
          own.emplace_back(
              AddNuisance(
                  BaseParameter("timing" + at + "." + name, "1",
                                "share of the cycle by which this muscle's bursts are early beyond it",
                                -kMostTiming, kMostTiming, 0),
                  kSpeedMuscleTiming),
              EmgTerm::kTiming);
        }
        own.emplace_back(AddNuisance(BaseParameter("gain" + at + "." + name, "1",
                                                   "logarithm of the gain at this speed beyond the law",
                                                   -kMostGain, kMostGain, 0),
                                     kSpeedGain),
                         EmgTerm::kGain);
        for (std::size_t t = 0; t < data_.trials.size(); ++t) {
          if (data_.trials[t].group != static_cast<int>(s)) continue;
          for (const auto& [index, term] : own) Touch(t, m, {index, term, EmgAlong::kOne, 0, 1});
        }
      }
    }
  }

  void AddCycles() {
    for (std::size_t t = 0; t < data_.trials.size(); ++t) {
      AddSharedTimings(t);
      for (std::size_t m = 0; m < muscles(); ++m) AddBursts(t, m);
    }
  }

  // What all bursts of a cycle have in common, and what each has of its own.
  void AddBursts(std::size_t t, std::size_t m) {
    const EmgShapeTrial& trial = data_.trials[t];
    const EmgMuscle& muscle = data_.muscles[m];
    // Of timing, a part may be that of all muscles.
    const double shared = muscles() < 2 ? 0 : data_.shared_timing;
    const auto beyond = [&](double scatter) {
      return std::max(std::sqrt(std::max(scatter * scatter - shared * shared, 0.0)), kLeastOwn * scatter);
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
        together = AddScatter(of, "one cycle's", trial.name, factor.gain * muscle.gain.together,
                              factor.timing * common);
      }
      ++number;
      TouchWindow(t, m, w, together);
      const std::string of = fmt::format("@{}.{}.{}.{}", trial.name, cycle + 1, muscle.name, number);
      TouchWindow(
          t, m, w,
          AddScatter(of, "one burst's", trial.name, factor.gain * muscle.gain.own(), factor.timing * own));
    }
  }

  // Gain and timing; -1 where the scatter is 0.
  std::array<int, 2> AddScatter(const std::string& of, const std::string& whose, const std::string& trial,
                                double gain_scatter, double timing_scatter) {
    std::array<int, 2> added{-1, -1};
    if (gain_scatter > 0) {
      Parameter gain =
          BaseParameter("gain" + of, "1", "logarithm of " + whose + " gain", -kMostGain, kMostGain, 0);
      gain.trial = trial;
      added[0] = AddNuisance(std::move(gain), gain_scatter);
    }
    if (timing_scatter > 0) {
      Parameter timing =
          BaseParameter("timing" + of, "1", "share of the cycle by which " + whose + " EMG is early",
                        -kMostTiming, kMostTiming, 0);
      timing.trial = trial;
      added[1] = AddNuisance(std::move(timing), timing_scatter);
    }
    return added;
  }

  // @param added gain and timing; -1: none
  void TouchWindow(std::size_t t, std::size_t m, std::size_t window, const std::array<int, 2>& added) {
    const int which = static_cast<int>(window);
    if (added[0] >= 0) Touch(t, m, {added[0], EmgTerm::kGain, EmgAlong::kWindow, which, 1});
    if (added[1] >= 0) Touch(t, m, {added[1], EmgTerm::kTiming, EmgAlong::kWindow, which, 1});
  }

  // A person who is early is so with all muscles.
  void AddSharedTimings(std::size_t t) {
    const EmgShapeTrial& trial = data_.trials[t];
    if (!(data_.shared_timing > 0) || muscles() < 2) return;
    double factor = 0;
    for (const EmgScatterFactors& of : trial.scatter) factor += of.timing / static_cast<double>(muscles());
    std::map<int, int> of_cycle;
    for (std::size_t m = 0; m < muscles(); ++m) {
      for (std::size_t w = 0; w < trial.windows[m].size(); ++w) {
        const EmgWindow& window = trial.windows[m][w];
        if (!window.fitted) continue;
        const auto [found, first] = of_cycle.try_emplace(window.cycle, -1);
        if (first) {
          Parameter p = BaseParameter(fmt::format("timing@{}.{}", trial.name, window.cycle + 1), "1",
                                      "share of the cycle by which all muscles are early in it", -kMostTiming,
                                      kMostTiming, 0);
          p.trial = trial.name;
          found->second = AddNuisance(std::move(p), factor * data_.shared_timing);
        }
        TouchWindow(t, m, w, {-1, found->second});
      }
    }
  }

  void AddWarp() {
    Name("warp_with_speed", Level::kHuman,
         "at higher speeds parts of the cycle take longer and others shorter, as seen by the muscles",
         "the same movement at more speeds");
    // Both at their bounds and four times the reference speed: still one phase after the other.
    constexpr double kMost = 0.05;
    for (const auto& [name, along] :
         {std::pair{"warp_sine", EmgAlong::kSine}, std::pair{"warp_cosine", EmgAlong::kCosine}}) {
      const int index =
          Add(BaseParameter(name, "1", "amplitude of the phase's warp, per logarithm of the speed", -kMost,
                            kMost, 0),
              list_.effects.back().name);
      for (std::size_t t = 0; t < data_.trials.size(); ++t) {
        for (std::size_t m = 0; m < muscles(); ++m)
          Touch(t, m, {index, EmgTerm::kTiming, along, 0, LogSpeed(data_.trials[t])});
      }
    }
  }

  void AddFatigue() {
    Name("fatigue", Level::kHuman, "the EMG grows or fades from cycle to cycle",
         "a longer recording, or one after a rest");
    for (std::size_t m = 0; m < muscles(); ++m) {
      const int index = Add(BaseParameter(data_.muscles[m].name + ".fatigue", "1",
                                          "growth of the logarithm of the EMG per cycle", -0.2, 0.2, 0),
                            list_.effects.back().name);
      for (std::size_t t = 0; t < data_.trials.size(); ++t)
        Touch(t, m, {index, EmgTerm::kGain, EmgAlong::kCycle, 0, 1});
    }
  }

  void AddTrialFloors() {
    std::vector<std::size_t> fitted;
    for (std::size_t t = 0; t < data_.trials.size(); ++t) {
      if (data_.trials[t].role == BlockRole::kTrain) fitted.push_back(t);
    }
    if (fitted.size() < 2) return;
    for (const std::size_t t : fitted) {
      const std::string& trial = data_.trials[t].name;
      Name("noise_floor@" + trial, Level::kSensor, "the EMG of one trial lies on another noise floor",
           "a rest phase in every trial");
      list_.effects.back().trial = trial;
      for (std::size_t m = 0; m < muscles(); ++m) {
        Parameter p = BaseParameter(data_.muscles[m].name + ".floor@" + trial, "1",
                                    "floor of the trial beyond that of all", -0.3, 0.3, 0);
        p.trial = trial;
        const int index = Add(std::move(p), list_.effects.back().name);
        Touch(t, m, {index, EmgTerm::kOffset, EmgAlong::kOne, 0, 1});
      }
    }
  }

  void AddCrossTalk() {
    for (std::size_t m = 0; m < muscles(); ++m) {
      Name("cross_talk." + data_.muscles[m].name, Level::kSensor,
           "the electrode of this muscle hears the others too", "a contraction of the other muscles alone");
      const int index = Add(BaseParameter(list_.effects.back().name, "1",
                                          "share of the others' mean EMG in this muscle's", 0, 0.8, 0),
                            list_.effects.back().name);
      for (std::size_t t = 0; t < data_.trials.size(); ++t)
        Touch(t, m, {index, EmgTerm::kOffset, EmgAlong::kOthers, 0, 1});
    }
  }

  void AddPorts() {
    double longest = 0;
    for (const EmgShapeTrial& trial : data_.trials)
      longest = std::max(longest, trial.time.back() - trial.time.front());
    for (int k = 0; k < kHats; ++k) list_.hat_knots.push_back(longest * k / (kHats - 1));
    for (std::size_t m = 0; m < muscles(); ++m) {
      Port port{data_.muscles[m].name, "1", "EMG that no model of the muscle makes", {}};
      UnknownTerm term;
      term.name = port.name + "(time)";
      term.signal = "time";
      term.signal_unit = "s";
      term.knots = list_.hat_knots;
      for (int k = 0; k < kHats; ++k) {
        Parameter p =
            BaseParameter(fmt::format("{}.{}", term.name, k + 1), "1", "EMG of an unknown source", -1, 1, 0);
        const int index = Add(std::move(p), term.name);
        term.parameters.push_back(index);
        for (std::size_t t = 0; t < data_.trials.size(); ++t)
          Touch(t, m, {index, EmgTerm::kOffset, EmgAlong::kHat, k, 1});
      }
      port.terms.push_back(std::move(term));
      list_.ports.push_back(std::move(port));
    }
  }

  const EmgShapeSettings& settings_;
  const EmgShapeData& data_;
  EmgShapeParameters list_;
};

}  // namespace

EmgShapeParameters ListEmgShapeParameters(const EmgShapeSettings& settings, const EmgShapeData& data) {
  Builder builder(settings, data);
  builder.AddModel();
  builder.AddEffects();
  return builder.Take();
}

}  // namespace sinew
