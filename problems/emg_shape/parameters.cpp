#include "problems/emg_shape/parameters.h"

#include <algorithm>
#include <utility>

#include "problems/emg_shape/parameter_list.h"

namespace sinew {
namespace {

constexpr double kMuscleLead = 0.03;  // [s]
constexpr double kFloor = 0.02;
// Electromechanical delays are 0.01 to 0.1 s, and the envelope's filter and the measured angle have lags of
// their own.
constexpr double kOtherLeads[] = {0.1, 0.2, 0.3};  // [s]

void AddShape(EmgParameterList& to, std::size_t m) {
  const EmgMuscle& muscle = to.data.muscles[m];
  // An envelope has no negative values, its spline may dip a little.
  const double most = std::max(2.0, 2 * muscle.shape.maxCoeff());
  for (int j = 0; j < to.data.knots; ++j) {
    Parameter p =
        BaseParameter(fmt::format("{}.shape_{:02}_of_{}", muscle.name, j + 1, to.data.knots), "1",
                      "control point of the EMG's shape over a cycle", -most / 4, most, muscle.shape[j]);
    const int index = to.AddNuisance(std::move(p), 0);
    for (std::size_t t = 0; t < to.data.trials.size(); ++t)
      to.Touch(t, m, {index, EmgTerm::kShape, EmgAlong::kOne, j, 1});
  }
}

void AddFloor(EmgParameterList& to, std::size_t m) {
  Parameter p = BaseParameter(to.data.muscles[m].name + ".floor", "1",
                              "of the EMG, that no gain of a cycle or a speed changes", -0.1, 0.4, 0);
  p.prior = GaussianPrior{0, kFloor};
  const int index = to.Add(std::move(p));
  for (std::size_t t = 0; t < to.data.trials.size(); ++t)
    to.Touch(t, m, {index, EmgTerm::kOffset, EmgAlong::kOne, 0, 1});
}

// Where the shape lies in the cycle. A spline follows a shift of itself nearly, but the noise of valleys is
// less than what is missing: the shape would stay where it began, at the reference speed, and that speed
// alone would be on time.
void AddPhase(EmgParameterList& to, std::size_t m) {
  const int index =
      to.AddNuisance(BaseParameter(to.data.muscles[m].name + ".phase", "1",
                                   "share of the cycle by which the shape is early at all speeds",
                                   -kMaxTiming, kMaxTiming, 0),
                     0);
  for (std::size_t t = 0; t < to.data.trials.size(); ++t)
    to.Touch(t, m, {index, EmgTerm::kTiming, EmgAlong::kOne, 0, 1});
}

// Deviations at one speed from the laws of speed. A speed that was not measured has none.
void AddSpeeds(EmgParameterList& to) {
  if (to.data.trained_speeds() == 1) return;
  for (std::size_t m = 0; m < to.muscles(); ++m) AddPhase(to, m);
  for (std::size_t s = 0; s < to.data.speeds.size(); ++s) {
    // Where nothing is fitted, they may come from a run that was.
    if (!to.data.speeds[s].trained && to.data.trained_speeds() > 0) continue;
    const std::string at = "@" + to.data.speeds[s].label;
    const int shared = to.AddNuisance(
        BaseParameter("timing" + at, "1", "share of the cycle by which bursts are early at this speed",
                      -kMaxTiming, kMaxTiming, 0),
        kSpeedTiming);
    for (std::size_t m = 0; m < to.muscles(); ++m) {
      const std::string& name = to.data.muscles[m].name;
      std::vector<std::pair<int, EmgTerm>> own{{shared, EmgTerm::kTiming}};
      if (to.settings.timing_per_muscle) {
        own.emplace_back(
            to.AddNuisance(
                BaseParameter("timing" + at + "." + name, "1",
                              "share of the cycle by which this muscle's bursts are early beyond it",
                              -kMaxTiming, kMaxTiming, 0),
                kSpeedMuscleTiming),
            EmgTerm::kTiming);
      }
      own.emplace_back(to.AddNuisance(BaseParameter("gain" + at + "." + name, "1",
                                                    "logarithm of the gain at this speed beyond the law",
                                                    -kMaxGain, kMaxGain, 0),
                                      kSpeedGain),
                       EmgTerm::kGain);
      for (std::size_t t = 0; t < to.data.trials.size(); ++t) {
        if (to.data.trials[t].group != static_cast<int>(s)) continue;
        for (const auto& [index, term] : own) to.Touch(t, m, {index, term, EmgAlong::kOne, 0, 1});
      }
    }
  }
}

void AddModel(EmgParameterList& to) {
  for (std::size_t m = 0; m < to.muscles(); ++m) AddShape(to, m);
  if (to.Laws() && to.settings.amplitude_law) {
    for (std::size_t m = 0; m < to.muscles(); ++m) AddExponent(to, m, false);
  }
  if (to.Laws() && to.settings.lead_law) AddLead(to, false);
  if (to.settings.cycle_scatter) {
    for (std::size_t m = 0; m < to.muscles(); ++m) AddFloor(to, m);
  }
  AddSpeeds(to);
  if (to.settings.cycle_scatter) AddCycles(to);
}

}  // namespace

void AddExponent(EmgParameterList& to, std::size_t m, bool effect) {
  const int index = to.AddOf(
      effect, BaseParameter(to.data.muscles[m].name + ".amplitude_exponent", "1",
                            "exponent of the speed to which the EMG's size is proportional", -4, 6, 0));
  for (std::size_t t = 0; t < to.data.trials.size(); ++t)
    to.Touch(t, m, {index, EmgTerm::kGain, EmgAlong::kOne, 0, to.LogSpeed(to.data.trials[t])});
}

void AddLead(EmgParameterList& to, bool effect) {
  Parameter lead = BaseParameter("lead", "s", "by which bursts come before the movement, mean of all muscles",
                                 -0.5, 0.5, 0);
  lead.other_starts.assign(std::begin(kOtherLeads), std::end(kOtherLeads));
  const int shared = to.AddOf(effect, std::move(lead));
  const auto touch = [&](std::size_t m, int index, double factor) {
    for (std::size_t t = 0; t < to.data.trials.size(); ++t)
      to.Touch(t, m, {index, EmgTerm::kTiming, EmgAlong::kOne, 0, factor * to.Rhythm(to.data.trials[t])});
  };
  for (std::size_t m = 0; m < to.muscles(); ++m) touch(m, shared, 1);
  if (!to.settings.timing_per_muscle || effect) return;
  // Their sum is 0, or they and the shared one would not be identifiable: the last one compensates the
  // others.
  for (std::size_t m = 0; m + 1 < to.muscles(); ++m) {
    Parameter p = BaseParameter(to.data.muscles[m].name + ".lead", "s", "lead beyond the mean of all muscles",
                                -0.2, 0.2, 0);
    p.prior = GaussianPrior{0, kMuscleLead};
    const int own = to.Add(std::move(p));
    touch(m, own, 1);
    touch(to.muscles() - 1, own, -1);
  }
}

EmgShapeParameters ListEmgShapeParameters(const EmgShapeSettings& settings, const EmgShapeData& data) {
  EmgParameterList list(settings, data);
  AddModel(list);
  AddEffects(list);
  for (auto& columns : list.made.columns) {
    std::stable_sort(columns.begin(), columns.end(),
                     [](const EmgColumn& a, const EmgColumn& b) { return a.parameter < b.parameter; });
  }
  return std::move(list.made);
}

}  // namespace sinew
