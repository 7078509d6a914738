#include "problems/drive/settings.h"

#include <algorithm>

#include "base/text.h"

namespace sinew {

const std::vector<std::string> kDriveChannels{"position", "speed", "torque", "current"};
const std::vector<std::string> kDriveControllerNumbers{
    "kp", "ki", "kd", "control_period", "output_limit", "servo_error_gain"};

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

Result<DriveControllerSettings> ReadController(const YamlReader& yaml) {
  std::vector<std::string> known = kDriveControllerNumbers;
  known.insert(known.end(), {"kind", "output"});
  SINEW_TRY(yaml.OnlyKeys(known));
  SINEW_TRY(yaml.At("kind"));
  DriveControllerSettings controller;
  SINEW_ASSIGN(const auto kind, ReadChoice(yaml, "kind", {"servo", "pid_position", "pid_speed"}));
  controller.kind = kind == 0   ? DriveControllerKind::kServo
                    : kind == 1 ? DriveControllerKind::kPidPosition
                                : DriveControllerKind::kPidSpeed;
  SINEW_ASSIGN(const auto output, ReadChoice(yaml, "output", {"torque", "voltage"}));
  controller.gives_voltage = output == 1;
  for (const std::string& name : kDriveControllerNumbers) {
    if (!yaml.Has(name)) continue;
    SINEW_ASSIGN(const YamlReader value, yaml.At(name));
    SINEW_ASSIGN(controller.numbers[name], value.Number());
  }
  return controller;
}

}  // namespace

Result<DriveSettings> ReadDriveSettings(const YamlReader& yaml) {
  SINEW_TRY(yaml.OnlyKeys({"fit", "hold", "step", "controller"}));
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
  if (yaml.Has("controller")) {
    SINEW_ASSIGN(const YamlReader controller, yaml.At("controller"));
    SINEW_ASSIGN(settings.controller, ReadController(controller));
  }
  return settings;
}

}  // namespace sinew
