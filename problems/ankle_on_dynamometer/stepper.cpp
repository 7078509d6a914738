#include "problems/ankle_on_dynamometer/stepper.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/constants.h"
#include "base/text.h"
#include "problems/ankle_on_dynamometer/effects.h"

namespace sinew {

Result<std::unique_ptr<AnkleStepper>> AnkleStepper::Make(AnkleSettings settings,
                                                         const std::map<std::string, double>& values,
                                                         double rate, double cutoff) {
  constexpr double kSlowest = 50;
  constexpr double kFastest = 1e5;
  if (!(rate >= kSlowest && rate <= kFastest))
    return Fail("rate {} Hz: expected {} to {}", rate, kSlowest, kFastest);
  if (!(cutoff > 0 && cutoff <= rate / 6))
    return Fail("cut-off {} Hz: expected above 0, at most {}", cutoff, rate / 6);
  SINEW_ASSIGN(const ParameterList list, ListAnkleParameters(settings));
  std::vector<double> by_slot = AnkleDefaults(settings);
  for (std::size_t slot = 0; slot < by_slot.size(); ++slot) {
    if (list.index[slot] >= 0)
      by_slot[slot] = list.parameters[static_cast<std::size_t>(list.index[slot])].rest_value();
  }
  for (const auto& [name, value] : values) {
    SINEW_ASSIGN(const int index, FindParameter(list.parameters, name));
    const Parameter& p = list.parameters[static_cast<std::size_t>(index)];
    if (!(value >= p.lower && value <= p.upper))
      return Fail("{} = {}: expected {} to {}", name, value, p.lower, p.upper);
    for (std::size_t slot = 0; slot < by_slot.size(); ++slot) {
      if (list.index[slot] == index) by_slot[slot] = value;
    }
  }
  return std::unique_ptr<AnkleStepper>(
      new AnkleStepper(std::move(settings), std::move(by_slot), rate, cutoff));
}

AnkleStepper::AnkleStepper(AnkleSettings settings, std::vector<double> values, double rate, double cutoff)
    : settings_(std::move(settings)),
      values_(std::move(values)),
      period_(1 / rate),
      pole_(2 * kPi * cutoff),
      curves_(MuscleCurves::Default()),
      foot_(FootOf(settings_, values_)) {
  for (const AnkleMuscle& muscle : settings_.muscles) paths_.push_back(muscle.path);
  const double time = values_[kAnkleFilterTime];
  const double lead = paths_.empty() ? 0 : FilterLead(time, period_);
  late_ = std::max(0.0, values_[kAnkleDelay] + lead) / period_;
  const auto kept = static_cast<std::size_t>(late_) + 2;
  drive_.assign(paths_.size(), std::vector<double>(kept, 0.0));
  before_.assign(paths_.size() + 1, 0.0);
  now_ = before_;
  activations_.assign(ImplicitStep::kStages, before_);
  solutions_.stages.reserve(ImplicitStep::kStages);
  solutions_.fibres.reserve(ImplicitStep::kStages * paths_.size());
}

double AnkleStepper::DelayedDrive(std::size_t muscle) const {
  const std::vector<double>& ring = drive_[muscle];
  const auto whole = static_cast<std::size_t>(late_);
  const double share = late_ - static_cast<double>(whole);
  const auto ago = [&](std::size_t samples) { return ring[(newest_ + ring.size() - samples) % ring.size()]; };
  return ago(whole) + share * (ago(whole + 1) - ago(whole));
}

void AnkleStepper::Activate(std::vector<double>& activation) const {
  activation.back() = 0;
  for (std::size_t m = 0; m < paths_.size(); ++m) {
    activation[m] = std::max(0.0, ExponentialShape(DelayedDrive(m), values_[kAnkleShape]).activation);
    activation.back() += activation[m] / static_cast<double>(paths_.size());
  }
}

double AnkleStepper::Drive(std::size_t muscle, const double* excitations) const {
  const auto count = static_cast<int>(paths_.size()) - 1;
  double others = 0;
  for (std::size_t m = 0; m < paths_.size(); ++m) others += m == muscle ? 0 : excitations[m] / count;
  return std::min(ExcitationAsItWas(excitations[muscle], others, count, values_), 1.0);
}

Status AnkleStepper::Begin(double angle, const double* excitations) {
  filters_.clear();
  for (std::size_t m = 0; m < paths_.size(); ++m) {
    const double drive = Drive(m, excitations);
    filters_.emplace_back(FilterOfTimes(values_[kAnkleFilterTime], 0.0, period_));
    filters_.back().Settle(drive);
    std::fill(drive_[m].begin(), drive_[m].end(), drive);
  }
  Activate(before_);
  plate_ = {angle, 0, 0};
  angle_ = angle;
  run_ = std::make_unique<StrappedFootRun<double>>(settings_.foot, curves_, paths_, foot_, solutions_);
  return run_->Settle(0, plate_, before_);
}

Result<double> AnkleStepper::Step(double angle, const double* excitations) {
  if (!run_) return Fail("Step was called before Begin");
  for (std::size_t m = 0; m < paths_.size(); ++m) {
    const std::size_t next = (newest_ + 1) % drive_[m].size();
    drive_[m][next] = filters_[m].Next(Drive(m, excitations));
  }
  if (!paths_.empty()) newest_ = (newest_ + 1) % drive_.front().size();
  Activate(now_);
  // The low-pass of the angle, exactly, which runs straight from the last one to this one: what a ramp leaves
  // for ever, and what decays.
  const double slope = (angle - angle_) / period_;
  const double off = plate_.angle - angle_ + 2 * slope / pole_;
  const double way = plate_.velocity - slope + pole_ * off;
  const auto at = [&](double t) {
    const double decay = std::exp(-pole_ * t);
    const double left = (off + way * t) * decay;
    const double left_velocity = (way - pole_ * (off + way * t)) * decay;
    PlateMotion motion;
    motion.angle = angle_ + slope * (t - 2 / pole_) + left;
    motion.velocity = slope + left_velocity;
    motion.acceleration = -pole_ * (2 * left_velocity + pole_ * left);
    return motion;
  };
  std::array<PlateMotion, ImplicitStep::kStages> plate;
  for (std::size_t stage = 0; stage < plate.size(); ++stage) {
    const double share = ImplicitStep::kNodes[stage];
    plate[stage] = at(share * period_);
    for (std::size_t m = 0; m < now_.size(); ++m)
      activations_[stage][m] = before_[m] + share * (now_[m] - before_[m]);
  }
  solutions_.stages.clear();
  solutions_.fibres.clear();
  SINEW_TRY(run_->Step(period_, plate.data(), activations_.data()));
  plate_ = plate.back();
  angle_ = angle;
  before_.swap(now_);
  return run_->MachineTorque(plate_);
}

}  // namespace sinew
