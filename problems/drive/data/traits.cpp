#include "problems/drive/data/traits.h"

#include "problems/drive/data/channels.h"

namespace sinew {
namespace {

constexpr double kStandardGravity = 9.80665;  // [m/s2]

// The input that all trials share, and whether the joint is rotary.
Status FindUnits(const Dataset& data, DriveTraits& traits) {
  std::string first_trial;
  std::string position_unit;
  for (const auto& [name, trial] : data.trials) {
    const auto input = InputName(trial);
    if (!input) return Fail("trial '{}' {}", name, input.error().message);
    const Grid* grid = nullptr;
    const Channel* channel = InputIn(trial, *input, &grid);
    if (first_trial.empty()) {
      first_trial = name;
      traits.input_channel = *input;
      traits.input_unit = channel->unit;
    } else if (*input != traits.input_channel) {
      return Fail("trial '{}' is driven by '{}', trial '{}' by '{}': expected the same input in all trials",
                  first_trial, traits.input_channel, name, *input);
    }
    // C++17 lets a lambda capture names of a structured binding only like this.
    const auto check_unit = [&, &name = name, &trial = trial](const char* of, const char* rotary,
                                                              const char* linear) -> Status {
      const Channel* measured = MeasuredIn(trial, of, &grid);
      if (measured == nullptr) return {};
      const std::string& unit = measured->unit;
      if (unit != rotary && unit != linear) {
        return Fail("trial '{}': {} has unit '{}', expected {} (rotary) or {} (linear)", name, of, unit,
                    rotary, linear);
      }
      const std::string kind = unit == rotary ? "rad" : "m";
      if (!position_unit.empty() && position_unit != kind) {
        return Fail("trial '{}': {} has unit '{}', but the joint is {} elsewhere", name, of, unit,
                    position_unit == "rad" ? "rotary" : "linear");
      }
      position_unit = kind;
      return {};
    };
    SINEW_TRY(check_unit("position", "rad", "m"));
    SINEW_TRY(check_unit("speed", "rad/s", "m/s"));
  }
  if (data.trials.empty()) return Fail("holds no trial");
  if (position_unit.empty()) {
    return Fail("no trial has a measured position [rad or m] or speed [rad/s or m/s]: nothing to fit");
  }
  traits.rotary = position_unit == "rad";
  return {};
}

// What the input is, and which controller follows it.
Status FindInput(const DriveSettings& settings, DriveTraits& traits) {
  const std::string& input = traits.input_channel;
  const std::string expected = input == "torque" || input == "force" ? (traits.rotary ? "N*m" : "N")
                               : input == "voltage"                  ? "V"
                               : input == "duty"                     ? "1"
                               : settings.controller.kind == DriveControllerKind::kPidSpeed
                                   ? (traits.rotary ? "rad/s" : "m/s")
                                   : (traits.rotary ? "rad" : "m");
  if (traits.input_unit != expected) {
    return Fail("input '{}' has unit '{}', expected {} for a {} joint{}", input, traits.input_unit, expected,
                traits.rotary ? "rotary" : "linear", input == "reference" ? " with this controller" : "");
  }
  const bool closed = input == "reference";
  const DriveControllerKind kind = settings.controller.kind;
  if (closed && kind == DriveControllerKind::kNone) {
    return Fail("the input is a reference: expected the controller that follows it, under drive.controller");
  }
  if (!closed && kind != DriveControllerKind::kNone) {
    return Fail("drive.controller needs the input 'reference', but the trials are driven by '{}'", input);
  }
  traits.controller = kind;
  traits.input = input == "voltage" ? DriveInput::kVoltage
                 : input == "duty"  ? DriveInput::kDuty
                 : closed           ? DriveInput::kReference
                                    : DriveInput::kTorque;
  traits.electric = traits.input == DriveInput::kVoltage || traits.input == DriveInput::kDuty ||
                    kind == DriveControllerKind::kServo || (closed && settings.controller.gives_voltage);
  traits.integral_is_fitted = settings.controller.integral_is_fitted;
  traits.held = settings.hold;
  traits.signals[kSupplyVoltage] = traits.input == DriveInput::kDuty || kind == DriveControllerKind::kServo;
  return {};
}

// Constants that fix a base parameter.
Status FindFixed(const Dataset& data, DriveTraits& traits) {
  const std::vector<std::pair<const char*, DriveSlot>> kBase{
      {"inertia", kInertia},      {"viscous_friction", kViscousFriction}, {"gravity_torque", kGravityTorque},
      {"drive_gain", kDriveGain}, {"torque_constant", kTorqueConstant},   {"resistance", kResistance}};
  for (const auto& [name, slot] : kBase) {
    traits.fixed[slot] = ConstantOf(data, name);
    const bool may_be_zero = slot == kViscousFriction || slot == kGravityTorque;
    if (traits.fixed[slot] && !may_be_zero && !(*traits.fixed[slot] > 0)) {
      return Fail("constant '{}' is {}, expected above 0", name, *traits.fixed[slot]);
    }
  }
  return {};
}

// Signals that only effects need.
void FindOptionalSignals(const Dataset& data, DriveData& out) {
  for (const DriveSignalChannel& signal : DriveSignalChannels()) {
    if (!signal.optional) continue;
    const Grid* grid = nullptr;
    bool somewhere = false;
    std::string without;
    for (const auto& [name, trial] : data.trials) {
      const bool input = InputIn(trial, signal.name, &grid) != nullptr;
      somewhere = somewhere || input || MeasuredIn(trial, signal.name, &grid) != nullptr;
      if (!input && without.empty()) without = name;
    }
    out.traits.signals[signal.signal] = without.empty();
    if (somewhere && !without.empty()) {
      out.notes.push_back(fmt::format(
          "'{}' is not used: trial '{}' has no channel of kind input of that name", signal.name, without));
    }
  }
}

// Constants of the joint that are never fitted.
Status FindJoint(const Dataset& data, DriveTraits& traits, DriveJoint& joint) {
  joint.rotary = traits.rotary;
  joint.electric = traits.electric;
  const auto mass = ConstantOf(data, "load_mass");
  const auto length = ConstantOf(data, "load_length");
  if (traits.rotary && mass.has_value() != length.has_value()) {
    return Fail("constant '{}' is given without '{}': a known load needs both",
                mass ? "load_mass" : "load_length", mass ? "load_length" : "load_mass");
  }
  if (traits.rotary && mass) {
    joint.load_known = true;
    joint.load_inertia = *mass * *length * *length;
    joint.load_gravity = *mass * kStandardGravity * *length;
  }
  traits.load_known = joint.load_known;
  traits.load_inertia = joint.load_inertia;
  joint.incline_force = ConstantOf(data, "incline_force").value_or(0);
  joint.gear_ratio = ConstantOf(data, "gear_ratio").value_or(1);
  if (!(joint.gear_ratio > 0)) return Fail("constant 'gear_ratio' is {}, expected above 0", joint.gear_ratio);
  if (const auto poles = ConstantOf(data, "pole_pairs"); poles && *poles > 0 && traits.rotary) {
    traits.pole_period = 2 * 3.14159265358979323846 / (*poles * joint.gear_ratio);
  }
  return {};
}

}  // namespace

Status FindTraits(const Dataset& data, const DriveSettings& settings, DriveData& out) {
  DriveTraits& traits = out.traits;
  SINEW_TRY(FindUnits(data, traits));
  SINEW_TRY(FindInput(settings, traits));
  FindOptionalSignals(data, out);
  SINEW_TRY(FindFixed(data, traits));
  SINEW_TRY(FindJoint(data, traits, out.joint));
  out.command.input = traits.input;
  out.command.controller = traits.controller;
  if (settings.step) out.command.step = *settings.step;
  out.command.most_steps = settings.most_steps;
  return {};
}

}  // namespace sinew
