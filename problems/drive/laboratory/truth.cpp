#include "problems/drive/laboratory/truth.h"

#include <algorithm>
#include <utility>

#include "identify/observation/sensor_parameters.h"
#include "problems/drive/effects.h"
#include "problems/kit/hidden_effects.h"

namespace sinew {
namespace {

struct OutsiderNumber {
  const char* effect;
  const char* parameter;
  const char* unit;
  DriveTruthSlot slot;
  double lower;
  double upper;
  double null;
  const char* depends_on;
};

// Those of one effect are neighbours.
constexpr OutsiderNumber kOutsiders[] = {
    {"wear", "wear_rate", "N*m/rad", kWearRate, 0, 1e3, 0, "history"},
    {"tight_spot", "tight_spot_torque", "N*m", kTightSpotTorque, 0, 1e3, 0, "two signals"},
    {"tight_spot", "tight_spot_position", "rad", kTightSpotPosition, -10, 10, 0, "two signals"},
    {"tight_spot", "tight_spot_width", "rad", kTightSpotWidth, 1e-3, 10, 0.2, "two signals"},
    {"shifting_mass", "shift_rate", "N*m/s", kShiftRate, -1e3, 1e3, 0, "two signals"},
    {"hysteretic_spring", "hysteresis_torque", "N*m", kHysteresisTorque, 0, 1e3, 0, "history"},
    {"hysteretic_spring", "hysteresis_width", "rad", kHysteresisWidth, 1e-3, 10, 0.2, "history"},
    {"slow_clock", "clock_rate", "1", kClockRate, -0.01, 0.01, 0, "two signals"},
    {"drifting_damping", "damping_rate", "N*m/rad", kDampingRate, 0, 1e3, 0, "two signals"},
    {"end_stop", "stop_stiffness", "N*m/rad", kStopStiffness, 0, 1e4, 0, "position"},
    {"end_stop", "stop_position", "rad", kStopPosition, -10, 10, 0.3, "position"},
    {"hum", "hum_torque", "N*m", kHumTorque, 0, 1e3, 0, "periodic in time"},
    {"hum", "hum_frequency", "Hz", kHumFrequency, 0, 1e3, 1, "periodic in time"},
    {"hum", "hum_phase", "rad", kHumPhase, -10, 10, 0, "periodic in time"},
    {"torque_bump", "bump_torque", "N*m", kBumpTorque, -1e3, 1e3, 0, "position"},
    {"torque_bump", "bump_position", "rad", kBumpPosition, -10, 10, 0, "position"},
    {"torque_bump", "bump_width", "rad", kBumpWidth, 1e-3, 10, 0.15, "position"},
    {"coarse_command", "command_step", "N*m", kCommandStep, 0, 1e3, 0, "command"},
    {"lost_load", "lost_load", "1", kLostLoad, 0, 0.9, 0, "two signals"},
    {"lost_load", "lost_time", "s", kLostTime, 0, 1e6, 5, "two signals"},
    {"cubic_drag", "cubic_drag", "N*m*s3/rad3", kCubicDrag, 0, 1e3, 0, "velocity"},
    {"eccentric_encoder", "eccentricity", "rad", kEccentricity, 0, 1, 0, "position"},
    {"eccentric_encoder", "eccentricity_phase", "rad", kEccentricityPhase, -10, 10, 0, "position"},
};

ParameterList Outsiders() {
  ParameterList list;
  ParameterListBuilder add(list, kDriveTruthSlots);
  for (const OutsiderNumber& outsider : kOutsiders) {
    if (list.effects.empty() || list.effects.back().name != outsider.effect)
      add.BeginEffect(outsider.effect, Level::kRobot, "what no effect of the library is", "");
    add.Number(outsider.slot, outsider.parameter, outsider.unit, "", outsider.lower, outsider.upper,
               outsider.null);
  }
  return list;
}

// Ranges of effects are multiples of these: of a joint, from the smallest to the largest that is fitted.
DriveScales ScalesOf(double torque, double speed, double position, double duration) {
  DriveScales scales;
  scales.torque = scales.command = scales.motor_command = torque;
  scales.speed = speed;
  scales.position = position;
  scales.duration = scales.shortest = scales.session = duration;
  return scales;
}

// What a fitted model of such a joint has, its sensor of position included.
ParameterList Library(const std::string& input, const DriveScales& scales) {
  DriveTraits traits;
  traits.signals.fill(true);
  traits.session = true;
  traits.input_channel = input;
  if (input == "reference") {
    traits.input = DriveInput::kReference;
    traits.controller = DriveControllerKind::kPidSpeed;
    traits.input_unit = "rad/s";
  }
  DriveStarts starts;
  starts.fill(1);
  ParameterList list = ListDriveParameters(traits, scales, starts);
  ChannelSummary position;
  position.channel = "position";
  position.unit = "rad";
  position.magnitude = scales.position;
  position.duration = scales.duration;
  std::vector<Parameter> parameters;
  std::vector<Effect> effects;
  AddSensorEffects(position, parameters, effects);
  list.index.resize(kDriveTruthSlots, -1);
  ParameterListBuilder add(list);
  for (std::size_t i = 0; i < effects.size(); ++i)
    add.Copy(effects[i], parameters, kPositionOffset + static_cast<int>(i));
  return list;
}

// Ranges from the smallest joint's to the largest's.
ParameterList Library(const std::string& input) {
  ParameterList list = Library(input, ScalesOf(1e-3, 1e-3, 1e-3, 0.5));
  const ParameterList large = Library(input, ScalesOf(1e3, 1e3, 10, 1e3));
  const ParameterList brief = Library(input, ScalesOf(1e3, 1e3, 10, 0.5));
  for (std::size_t i = 0; i < list.parameters.size(); ++i) {
    Parameter& p = list.parameters[i];
    for (const ParameterList* other : {&large, &brief}) {
      p.lower = std::min(p.lower, other->parameters[i].lower);
      p.upper = std::max(p.upper, other->parameters[i].upper);
    }
  }
  return list;
}

// The slot of each parameter.
std::vector<int> SlotsOf(const ParameterList& list) {
  std::vector<int> slots(list.parameters.size(), 0);
  for (std::size_t slot = 0; slot < list.index.size(); ++slot) {
    if (list.index[slot] >= 0) slots[static_cast<std::size_t>(list.index[slot])] = static_cast<int>(slot);
  }
  return slots;
}

std::string DependsOn(const std::string& effect) {
  for (const OutsiderNumber& outsider : kOutsiders) {
    if (outsider.effect == effect) return outsider.depends_on;
  }
  return "";
}

}  // namespace

DriveTruth::DriveTruth() {
  DriveTruth& truth = *this;
  truth[kInertia] = 0.04;
  truth[kViscousFriction] = 0.05;
  truth[kGravityTorque] = 0.6;
  truth[kInputGain] = 1;
  truth[kPositionGain] = 1;
  truth[kStribeckVelocity] = 0.1;
  truth[kStribeckLoadVelocity] = 0.1;
  truth[kCoggingPeriod] = 1;
  truth[kWarmUpTime] = 1;
  for (const OutsiderNumber& outsider : kOutsiders) truth[outsider.slot] = outsider.null;
}

std::vector<DriveTruthEntry> DriveTruthEntries(const std::string& input) {
  std::vector<DriveTruthEntry> entries;
  for (const ParameterList& list : {Library(input), Outsiders()}) {
    const std::vector<int> slots = SlotsOf(list);
    for (const Effect& effect : list.effects) {
      for (const int index : effect.parameters) {
        const Parameter& p = list.parameters[static_cast<std::size_t>(index)];
        entries.push_back({effect.name, p.name, p.unit, slots[static_cast<std::size_t>(index)], p.lower,
                           p.upper, DependsOn(effect.name)});
      }
    }
  }
  return entries;
}

Status HideEffects(const RequestedEffects& effects, const std::string& input, DriveTruth& truth) {
  SINEW_ASSIGN(const auto hidden, ReadHiddenEffects(effects, Library(input), Outsiders()));
  for (const DriveTruthEntry& entry : DriveTruthEntries(input)) {
    const auto found = hidden.find(entry.parameter);
    if (found != hidden.end()) truth[entry.slot] = found->second;
  }
  return {};
}

}  // namespace sinew
