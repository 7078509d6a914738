#include "problems/drive/settings.h"

#include <algorithm>

#include "base/text.h"

namespace sinew {

const std::vector<std::string> kDriveChannels{"position", "speed", "torque", "current"};
const std::vector<std::string> kDriveControllerNumbers{"kp",
                                                       "ki",
                                                       "kd",
                                                       "position_gain",
                                                       "velocity_gain",
                                                       "velocity_integral",
                                                       "velocity_filter",
                                                       "velocity_feedforward",
                                                       "acceleration_feedforward",
                                                       "speed_limit",
                                                       "control_period",
                                                       "output_limit",
                                                       "servo_error_gain"};

namespace {

Result<std::size_t> ReadChoice(const YamlReader& yaml, const std::string& key,
                               const std::vector<std::string>& names) {
  if (!yaml.Has(key)) return std::size_t{0};
  SINEW_ASSIGN(const YamlReader value, yaml.At(key));
  SINEW_ASSIGN(const std::string name, value.Text());
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    return FailAt(value.file(), value.line(), "{}: '{}' does not exist{}", key, name,
                  Suggestion(name, names));
  }
  return static_cast<std::size_t>(found - names.begin());
}

struct ControllerKind {
  const char* name;
  DriveControllerKind kind;
  std::vector<std::string> keys;  // that it may have besides its kind
};

const std::vector<ControllerKind>& ControllerKinds() {
  static const std::vector<std::string> kPid{
      "kp", "ki", "kd", "control_period", "output", "output_limit", "initial_integral"};
  static const std::vector<ControllerKind> kKinds{
      {"servo", DriveControllerKind::kServo, {"kp", "servo_error_gain"}},
      {"pid_position", DriveControllerKind::kPidPosition, kPid},
      {"pid_speed", DriveControllerKind::kPidSpeed, kPid},
      {"cascade",
       DriveControllerKind::kCascade,
       {"position_gain", "velocity_gain", "velocity_integral", "velocity_filter", "velocity_feedforward",
        "acceleration_feedforward", "speed_limit", "control_period", "output", "output_limit",
        "initial_integral"}}};
  return kKinds;
}

// A number that this controller has no use for is a mistake, not a detail.
Status OnlyKeysOf(const ControllerKind& kind, const YamlReader& yaml) {
  std::vector<std::string> known = kDriveControllerNumbers;
  known.insert(known.end(), {"kind", "output", "initial_integral"});
  SINEW_TRY(yaml.OnlyKeys(known));
  for (const std::string& key : known) {
    const bool used = key == "kind" || std::find(kind.keys.begin(), kind.keys.end(), key) != kind.keys.end();
    if (used || !yaml.Has(key)) continue;
    SINEW_ASSIGN(const YamlReader value, yaml.At(key));
    return FailAt(value.file(), value.line(), "controller: {} has no '{}', expected {}", kind.name, key,
                  Join(kind.keys, ", "));
  }
  return {};
}

Result<DriveControllerSettings> ReadController(const YamlReader& yaml) {
  SINEW_TRY(yaml.At("kind"));
  std::vector<std::string> names;
  for (const ControllerKind& kind : ControllerKinds()) names.emplace_back(kind.name);
  SINEW_ASSIGN(const auto chosen, ReadChoice(yaml, "kind", names));
  const ControllerKind& kind = ControllerKinds()[chosen];
  SINEW_TRY(OnlyKeysOf(kind, yaml));
  DriveControllerSettings controller;
  controller.kind = kind.kind;
  // `force` and `torque` name the same, as in `fit`.
  SINEW_ASSIGN(const auto output, ReadChoice(yaml, "output", {"torque", "voltage", "force"}));
  controller.gives_voltage = output == 1;
  SINEW_ASSIGN(const auto integral, ReadChoice(yaml, "initial_integral", {"zero", "fitted"}));
  controller.integral_is_fitted = integral == 1;
  for (const std::string& name : kDriveControllerNumbers) {
    if (!yaml.Has(name)) continue;
    SINEW_ASSIGN(const YamlReader value, yaml.At(name));
    SINEW_ASSIGN(controller.numbers[name], value.Number());
  }
  return controller;
}

}  // namespace

Result<DriveSettings> ReadDriveSettings(const YamlReader& yaml) {
  SINEW_TRY(yaml.OnlyKeys({"fit", "hold", "step", "most_steps", "controller"}));
  DriveSettings settings;
  if (yaml.Has("fit")) {
    SINEW_ASSIGN(const YamlReader fit, yaml.At("fit"));
    SINEW_ASSIGN(settings.fit, fit.Texts());
    for (std::string& channel : settings.fit) {
      if (channel == "force") channel = "torque";  // of a linear axis; `force` and `torque` name the same
      if (std::find(kDriveChannels.begin(), kDriveChannels.end(), channel) != kDriveChannels.end()) continue;
      return FailAt(fit.file(), fit.line(), "fit: channel '{}' does not exist{}", channel,
                    Suggestion(channel, kDriveChannels));
    }
    if (settings.fit.empty()) return FailAt(fit.file(), fit.line(), "fit: expected at least one channel");
  }
  SINEW_ASSIGN(const auto hold, ReadChoice(yaml, "hold", {"linear", "zero"}));
  settings.hold = hold == 1;
  if (yaml.Has("step")) {
    SINEW_ASSIGN(const YamlReader step, yaml.At("step"));
    SINEW_ASSIGN(settings.step, step.Number());
    if (!(*settings.step >= 1e-6 && *settings.step <= 1)) {
      return FailAt(step.file(), step.line(), "step: {} s, expected 1e-6 to 1 s", *settings.step);
    }
  }
  SINEW_ASSIGN(settings.most_steps, yaml.NumberOr("most_steps", settings.most_steps, 1, 1e9));
  if (yaml.Has("controller")) {
    SINEW_ASSIGN(const YamlReader controller, yaml.At("controller"));
    SINEW_ASSIGN(settings.controller, ReadController(controller));
  }
  return settings;
}

}  // namespace sinew
