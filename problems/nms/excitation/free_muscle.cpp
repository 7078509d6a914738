#include "problems/nms/excitation/free_muscle.h"

#include <algorithm>

namespace sinew {
namespace {

constexpr double kSameTime = 1e-9;  // [s]

// Straight lines between samples, the ends go on.
double Between(const std::vector<double>& time, const std::vector<double>& values, double at) {
  if (at <= time.front()) return values.front();
  if (at >= time.back()) return values.back();
  const auto k = static_cast<std::size_t>(std::upper_bound(time.begin(), time.end(), at) - time.begin());
  return values[k - 1] + (at - time[k - 1]) / (time[k] - time[k - 1]) * (values[k] - values[k - 1]);
}

FilterCoefficients<Dual<1>> Filter(const MuscleModel& model, const std::array<double, kMuscleSlots>& numbers,
                                   const std::vector<double>& time) {
  const Dual<1> mean = numbers[kFilterMean];
  const Dual<1> spread = numbers[kFilterSpread];
  if (model.as_ceinms) return FilterOfCoefficients(mean, spread);
  return FilterOfTimes(mean, spread, (time.back() - time.front()) / static_cast<double>(time.size() - 1));
}

}  // namespace

ActingExcitations ActAtFrames(const MuscleModel& model, const std::array<double, kMuscleSlots>& numbers,
                              const MuscleSignals& signals) {
  ActingExcitations acting;
  const std::vector<double>& sent = signals.excitation_time;
  const std::vector<double>& frames = signals.time;
  const double delay = numbers[kDelay];
  if (!model.as_ceinms) {
    const double step = (frames.back() - frames.front()) / static_cast<double>(frames.size() - 1);
    const double late = delay + FilterLead(numbers[kFilterMean], step);
    for (const double t : frames) {
      acting.time.push_back(t - late);
      acting.value.push_back(Between(sent, signals.excitation, t - late));
    }
    return acting;
  }
  std::size_t k = 0;
  const auto is_due = [&](double t) { return k + 1 < sent.size() && sent[k] + delay < t - kSameTime; };
  for (; is_due(frames.front()); ++k) {
    acting.time.push_back(sent[k]);
    acting.value.push_back(signals.excitation[k]);
  }
  acting.frames_from = k;
  for (const double t : frames) {
    while (is_due(t)) ++k;
    acting.time.push_back(t - delay);
    acting.value.push_back(signals.excitation[k]);
  }
  return acting;
}

FreeMuscle::FreeMuscle(const MuscleCurves& curves, const MuscleModel& model,
                       const std::array<double, kMuscleSlots>& numbers, const MuscleSignals& signals,
                       const ActingExcitations& acting, const MuscleTrace<double>& trace)
    : curves_(curves),
      model_(model),
      signals_(signals),
      trace_(trace),
      muscle_{numbers[kOptimalLength], numbers[kTendonSlackLength], numbers[kIsometricForce],
              numbers[kStrength],      numbers[kPennation],         numbers[kLengthChange],
              numbers[kDamping],       numbers[kLargestVelocity]},
      sine_(Sin(muscle_.pennation)),
      shape_(numbers[kShape]),
      filter_(Filter(model, numbers, acting.time)),
      settles_(!model.as_ceinms),
      history_(numbers[kEnhancement], numbers[kDepression]),
      remembers_(numbers[kEnhancement] != 0 || numbers[kDepression] != 0),
      length_(signals.unit_length) {
  for (std::size_t j = 0; j < signals.arms.size(); ++j) {
    for (std::size_t i = 0; i < length_.size(); ++i)
      length_[i] -= ShorteningAt(signals, j, i, numbers[kAngleOffset + j]);
  }
  filter_.Settle(0.0);
  for (std::size_t k = 0; k < acting.frames_from; ++k) filter_.Next(acting.value[k]);
  if (model.tendon == TendonMode::kElastic) {
    fibre_.emplace(curves_, muscle_);
  } else if (remembers_) {
    history_.Pass(signals.time[0], trace.fibre_velocity[0] / numbers[kOptimalLength]);
    muscle_.active_gain = history_.Factor();
  }
}

FreeMuscle::Slope FreeMuscle::Activation(ExcitationFilter<Slope>& filter, const Slope& excitation) const {
  if (settles_ && frame_ == 0) filter.Settle(excitation);
  return Shaped(model_.shape, filter.Next(excitation), shape_);
}

Result<ForceAt> FreeMuscle::Force(double excitation) const {
  ExcitationFilter<Slope> filter = filter_;
  const Slope activation = Activation(filter, Slope::Variable(excitation, 0));
  if (fibre_) {
    ElasticFibre<Slope> fibre = *fibre_;
    SINEW_ASSIGN(const Fibre<Slope> at, fibre.Next(signals_.time[frame_], length_[frame_], activation));
    return ForceAt{at.tendon_force.value, at.tendon_force.d[0]};
  }
  const Slope length = trace_.fibre_length[frame_];
  const Slope force = FibreForce(curves_, muscle_, length, Slope(trace_.fibre_velocity[frame_]), activation) *
                      PennationCosine(muscle_, sine_, length);
  return ForceAt{force.value, force.d[0]};
}

Result<double> FreeMuscle::Choose(double excitation) {
  SINEW_ASSIGN(const ForceAt chosen, Force(excitation));
  const Slope activation = Activation(filter_, Slope(excitation));
  double velocity = 0;
  if (fibre_) {
    SINEW_ASSIGN(const Fibre<Slope> at, fibre_->Next(signals_.time[frame_], length_[frame_], activation));
    velocity = at.velocity.value;
  } else if (frame_ + 1 < signals_.time.size()) {
    velocity = trace_.fibre_velocity[frame_ + 1];
  }
  const std::size_t passed = fibre_ ? frame_ : frame_ + 1;
  ++frame_;
  if (remembers_ && passed < signals_.time.size()) {
    history_.Pass(signals_.time[passed], velocity / muscle_.optimal_length.value);
    muscle_.active_gain = history_.Factor();
  }
  return chosen.force;
}

}  // namespace sinew
