// One trial of the ankle problem, from values by slot to what happens at its stops.
#pragma once

#include <utility>
#include <vector>

#include "models/dynamometer/strapped_foot_run.h"
#include "models/muscle/activation.h"
#include "models/muscle/cross_talk.h"
#include "problems/ankle_on_dynamometer/data.h"
#include "problems/ankle_on_dynamometer/effects.h"

namespace sinew {

/// The excitation of a muscle as it was. @param measured its own @param others mean of the others' measured
/// ones
/// @param count of the others
template <class T>
[[nodiscard]] T ExcitationAsItWas(double measured, double others, int count, const std::vector<T>& values) {
  T excitation = values[kUnseenDrive];
  excitation += count > 0 ? WithoutCrossTalk(measured, others, count, values[kEmgCrossTalk]) : T(measured);
  return Value(excitation) >= 0 ? excitation : T(0.0);
}

/// Sample k of every muscle's excitation as it was, given the measured ones.
template <class T>
class ExcitationsOf {
 public:
  ExcitationsOf(const AnkleTrial& trial, const std::vector<T>& values) : trial_(trial), values_(values) {}

  [[nodiscard]] T operator()(std::size_t muscle, std::size_t k) const {
    const auto count = static_cast<int>(trial_.excitations.size()) - 1;
    double others = 0;
    for (std::size_t m = 0; m < trial_.excitations.size(); ++m)
      others += m == muscle ? 0 : trial_.excitations[m][k] / count;
    return ExcitationAsItWas(trial_.excitations[muscle][k], others, count, values_);
  }

 private:
  const AnkleTrial& trial_;
  const std::vector<T>& values_;
};

/// Activations at every stage time, [stages][muscles, and their mean]. @param knots [muscles]
template <class T>
void ComputeActivations(const AnkleTrial& trial, const std::vector<ActivationKnots>& knots,
                        const std::vector<T>& values, std::vector<std::vector<T>>& activations) {
  const std::size_t muscles = knots.size();
  activations.assign(trial.stage_times.size(), std::vector<T>(muscles + 1, T(0.0)));
  if (trial.excitation_time.empty() || muscles == 0) return;
  const auto& t = trial.excitation_time;
  const double step = (t.back() - t.front()) / static_cast<double>(t.size() - 1);
  const T& time = values[kAnkleFilterTime];
  const auto coefficients = FilterOfTimes(time, T(0.0), step);
  const T late = values[kAnkleDelay] + FilterLead(time, step);
  const ExcitationsOf<T> excitation(trial, values);
  const double begin = trial.stage_times.front();
  std::vector<T> neural(t.size(), T(0.0));
  for (std::size_t m = 0; m < muscles; ++m) {
    const UnknownShare<T> unknown(knots[m],
                                  &values[static_cast<std::size_t>(SlotOfMuscle(m, kActivationTerm))]);
    ExcitationFilter<T> filter(coefficients);
    filter.Settle(excitation(m, 0));
    for (std::size_t k = 0; k < t.size(); ++k) neural[k] = filter.Next(excitation(m, k));
    std::size_t after = 1;
    for (std::size_t i = 0; i < trial.stage_times.size(); ++i) {
      const T at = trial.stage_times[i] - late;
      while (after + 1 < t.size() && t[after] <= Value(at)) ++after;
      while (after > 1 && t[after - 1] > Value(at)) --after;
      T u = Value(at) <= t.front() ? neural.front() : neural.back();
      if (Value(at) > t.front() && Value(at) < t.back()) {
        const T share = (at - t[after - 1]) * (1 / (t[after] - t[after - 1]));
        u = neural[after - 1] + share * (neural[after] - neural[after - 1]);
      }
      T active = Shaped(ActivationShape::kExponential, u, values[kAnkleShape]);
      active = active * (1.0 - values[kFatigue] * (trial.stage_times[i] - begin));
      if (unknown.acts())
        active += active * unknown.At(trial.stage_times[i] - begin, trial.stage_angles[i], u);
      if (!(Value(active) > 0)) active = T(0.0);
      activations[i][m] = active;
      activations[i][muscles] += active * (1 / static_cast<double>(muscles));
    }
  }
}

/// Calls see(stop, torque, run) at every stop; run is nullptr without a foot. @param solutions of the plain
/// run, which those with derivatives follow Errors: no equilibrium of foot or fibre, with the time.
template <class T, class See>
Status RunAnkleTrial(const AnkleData& data, const AnkleTrial& trial, const std::vector<T>& values,
                     FootSolutions& solutions, const See& see) {
  const StrappedFoot<T> foot = FootOf(data.settings, values);
  using Run = StrappedFootRun<T>;
  if (trial.task == AnkleTask::kAttachmentAlone) {
    for (std::size_t s = 0; s < trial.stops.size(); ++s)
      see(s, Run::AttachmentTorque(foot.attachment, data.settings.foot, trial.plate[s], T(0.0)),
          static_cast<const Run*>(nullptr));
    return {};
  }
  std::vector<std::vector<T>> activations;
  ComputeActivations(trial, data.settings.knots.activation, values, activations);
  Run run(data.settings.foot, data.curves, data.paths, foot, solutions);
  SINEW_TRY(run.Settle(trial.stops.front(), trial.plate.front(), activations.front()));
  see(std::size_t{0}, run.MachineTorque(trial.plate.front()), &std::as_const(run));
  std::size_t stage = 1;
  for (const AnkleTrial::Step& step : trial.steps) {
    SINEW_TRY(run.Step(step.length, step.plate.data(), &activations[stage]));
    stage += ImplicitStep::kStages;
    if (step.stop >= 0) {
      const auto s = static_cast<std::size_t>(step.stop);
      see(s, run.MachineTorque(trial.plate[s]), &std::as_const(run));
    }
  }
  return {};
}

}  // namespace sinew
