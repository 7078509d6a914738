#include "problems/drive/data/channels.h"

#include <vector>

#include "base/text.h"

namespace sinew {
namespace {

const std::vector<std::string> kInputs{"torque", "force", "voltage", "duty", "reference"};

const Channel* ChannelIn(const Trial& trial, const std::string& name, ChannelKind kind, const Grid** grid) {
  for (const auto& [grid_name, g] : trial.grids) {
    const auto found = g.channels.find(name);
    if (found == g.channels.end() || found->second.kind != kind) continue;
    *grid = &g;
    return &found->second;
  }
  return nullptr;
}

}  // namespace

const Channel* MeasuredIn(const Trial& trial, const std::string& name, const Grid** grid) {
  return ChannelIn(trial, name, ChannelKind::kMeasured, grid);
}

const Channel* InputIn(const Trial& trial, const std::string& name, const Grid** grid) {
  return ChannelIn(trial, name, ChannelKind::kInput, grid);
}

const std::vector<DriveSignalChannel>& DriveSignalChannels() {
  static const std::vector<DriveSignalChannel> kChannels{{kSupplyVoltage, "supply_voltage", "V"},
                                                         {kTemperature, "temperature", "K", true}};
  return kChannels;
}

Result<std::string> InputName(const Trial& trial) {
  std::vector<std::string> found;
  const Grid* grid = nullptr;
  for (const std::string& name : kInputs) {
    if (InputIn(trial, name, &grid) != nullptr) found.push_back(name);
  }
  if (found.size() == 1) return found.front();
  if (found.size() > 1)
    return Fail("has {} inputs ({}), expected exactly one", found.size(), Join(found, ", "));
  for (const std::string& name : kInputs) {
    if (MeasuredIn(trial, name, &grid) == nullptr) continue;
    return Fail(
        "channel '{}' is marked measured, not input; if it drives the joint, import it with kind: input",
        name);
  }
  return Fail("has no input: expected a channel of kind input named {}", Join(kInputs, ", "));
}

std::optional<double> ConstantOf(const Dataset& data, const std::string& name) {
  const auto found = data.constants.find(name);
  if (found == data.constants.end()) return {};
  return found->second.value;
}

std::optional<double> NumberOf(const Dataset& data, const Trial& trial, const std::string& name) {
  const auto found = trial.conditions.find(name);
  if (found != trial.conditions.end()) return found->second;
  return ConstantOf(data, name);
}

std::string DescribeDriveChannels() {
  return "input (kind: input), exactly one, without gaps, any sampling:\n"
         "  torque or force        N*m, N        of the drive\n"
         "  voltage                V             at the motor\n"
         "  duty                   1             share of supply_voltage at the motor\n"
         "  reference              rad, rad/s (linear: m, m/s)   of the known controller, see drive.yaml\n"
         "input besides it (kind: input), optional, in every trial, without gaps:\n"
         "  temperature            K (or degC)   of the joint: effect friction_with_temperature\n"
         "input besides it (kind: input), optional, in any trial, without gaps:\n"
         "  motor_on               1             0 where the motor is off: no torque, no current; held "
         "between samples\n"
         "  disturbance            N*m, N or V   added to the output of a sampled controller\n"
         "measured, any sampling, gaps are left out; position or speed is needed:\n"
         "  position               rad or m      determines whether the joint is rotary or linear\n"
         "  speed                  rad/s or m/s\n"
         "  torque or force        N*m, N        of the drive, if it is not the input\n"
         "  current                A             of an electric drive\n"
         "constants, all optional:\n"
         "  load_mass, load_length kg, m         a known load on a rotary joint: fixes the scale of torque\n"
         "  gear_ratio             1             between motor and joint; default 1\n"
         "  supply_voltage         V             needed for duty and servos; also a condition or an input\n"
         "  incline_force          N             gravity along a linear axis\n"
         "  pole_pairs             1             of the motor, for cogging\n"
         "  kp, ki, kd, ...                      of the controller; also conditions of a trial; kd acts on "
         "the\n"
         "                                       change of the error, that of the reference included\n"
         "  position_gain, ...                   of a cascade, see drive.yaml in docs/drive.md\n"
         "  inertia, torque_constant, ...        fixes the base parameter of that name\n"
         "conditions of a trial, optional, in all trials or in none:\n"
         "  session_time_s         s             when its time 0 was in the session: effect "
         "gain_over_session\n"
         "files:\n"
         "  drive.yaml                           settings with key `drive` (optional; or give --config)\n";
}

}  // namespace sinew
