#include "problems/drive/laboratory/truth.h"

#include <algorithm>

#include "base/numbers.h"
#include "base/text.h"

namespace sinew {

std::vector<DriveTruthEntry> DriveTruthEntries(const std::string& input) {
  using T = DriveTruth;
  const std::string of_input = input == "reference" ? "rad/s" : "N*m";
  std::vector<DriveTruthEntry> entries{
      {"coulomb_friction", "coulomb_torque", "N*m", &T::coulomb_torque, 0, 1e3},
      {"asymmetric_friction", "forward_friction", "N*m", &T::forward_friction, 0, 1e3},
      {"asymmetric_friction", "backward_friction", "N*m", &T::backward_friction, 0, 1e3},
      {"stribeck_friction", "stribeck_torque", "N*m", &T::stribeck_torque, 0, 1e3},
      {"stribeck_friction", "stribeck_velocity", "rad/s", &T::stribeck_velocity, 1e-4, 1e3},
      {"load_friction", "load_friction_coefficient", "1", &T::load_friction_coefficient, 0, 10},
      {"directional_friction", "motor_load_friction", "1", &T::motor_load_friction, 0, 10},
      {"directional_friction", "external_load_friction", "1", &T::external_load_friction, 0, 10},
      {"stribeck_load_friction", "stribeck_load_coefficient", "1", &T::stribeck_load_coefficient, 0, 10},
      {"stribeck_load_friction", "stribeck_load_velocity", "rad/s", &T::stribeck_load_velocity, 1e-4, 1e3},
      {"quadratic_load_friction", "quadratic_load_coefficient", "1/(N*m)", &T::quadratic_load_coefficient, 0,
       1e3},
      {"quadratic_drag", "drag_coefficient", "N*m*s2/rad2", &T::drag_coefficient, 0, 1e3},
      {"backlash", "backlash_width", "rad", &T::backlash_width, 0, 1},
      {"compliance", "transmission_compliance", "rad/(N*m)", &T::transmission_compliance, 0, 1},
      {"command_delay", "command_delay", "s", &T::command_delay, 0, 1},
      {"sensing_delay", "sensing_delay", "s", &T::sensing_delay, 0, 1},
      {"torque_saturation", "inverse_torque_limit", "1/(N*m)", &T::inverse_torque_limit, 0, 1e6},
      {"speed_saturation", "inverse_speed_limit", "s/rad", &T::inverse_speed_limit, 0, 1e6},
      {"cogging", "cogging_cos", "N*m", &T::cogging_cos, -1e3, 1e3},
      {"cogging", "cogging_sin", "N*m", &T::cogging_sin, -1e3, 1e3},
      {"cogging", "cogging_period", "rad", &T::cogging_period, 1e-3, 1e3},
      {"gravity_imbalance", "imbalance_torque", "N*m", &T::imbalance_torque, -1e3, 1e3},
      {"parallel_spring", "spring_stiffness", "N*m/rad", &T::spring_stiffness, 0, 1e4},
      {"torque_offset", "offset_torque", "N*m", &T::offset_torque, -1e3, 1e3},
      {"gain_compression", "compression", "1", &T::compression, 0, 1},
      {"supply_sag", "thermal_rate", "1/s", &T::thermal_rate, 0, 1},
      {"hold", "hold_fraction", "1", &T::hold_fraction, 0, 1},
      {input + ".offset", input + ".offset", of_input, &T::input_offset, -1e3, 1e3},
      {input + ".drift", input + ".drift", of_input + "/s", &T::input_drift, -1e3, 1e3},
      {input + ".gain", input + ".gain", "1", &T::input_gain, 0.01, 100},
      {input + ".time_offset", input + ".time_offset", "s", &T::input_time_offset, -0.2, 0.2},
      {input + ".low_pass", input + ".low_pass", "s", &T::input_low_pass, 0, 1},
      {"position.offset", "position.offset", "rad", &T::position_offset, -10, 10},
      {"position.drift", "position.drift", "rad/s", &T::position_drift, -10, 10},
      {"position.gain", "position.gain", "1", &T::position_gain, 0.01, 100},
      {"position.time_offset", "position.time_offset", "s", &T::position_time_offset, -0.15, 0.15},
      {"position.low_pass", "position.low_pass", "s", &T::position_low_pass, 0, 1},
      {"position.saturation", "position.saturation", "1/rad", &T::position_saturation, 0, 1e6},
      {"position.quantisation", "position.quantisation", "rad", &T::position_quantisation, 0, 10},
      {"wear", "wear_rate", "N*m/rad", &T::wear_rate, 0, 1e3, "history"},
      {"tight_spot", "tight_spot_torque", "N*m", &T::tight_spot_torque, 0, 1e3, "two signals"},
      {"tight_spot", "tight_spot_position", "rad", &T::tight_spot_position, -10, 10, "two signals"},
      {"tight_spot", "tight_spot_width", "rad", &T::tight_spot_width, 1e-3, 10, "two signals"},
      {"shifting_mass", "shift_rate", "N*m/s", &T::shift_rate, -1e3, 1e3, "two signals"},
      {"hysteretic_spring", "hysteresis_torque", "N*m", &T::hysteresis_torque, 0, 1e3, "history"},
      {"hysteretic_spring", "hysteresis_width", "rad", &T::hysteresis_width, 1e-3, 10, "history"},
      {"slow_clock", "clock_rate", "1", &T::clock_rate, -0.01, 0.01, "two signals"},
      {"drifting_damping", "damping_rate", "N*m/rad", &T::damping_rate, 0, 1e3, "two signals"},
      {"cubic_spring", "cubic_stiffness", "N*m/rad3", &T::cubic_stiffness, 0, 1e4, "position"},
      {"hum", "hum_torque", "N*m", &T::hum_torque, 0, 1e3, "periodic in time"},
      {"hum", "hum_frequency", "Hz", &T::hum_frequency, 0, 1e3, "periodic in time"},
      {"hum", "hum_phase", "rad", &T::hum_phase, -10, 10, "periodic in time"},
      {"torque_bump", "bump_torque", "N*m", &T::bump_torque, -1e3, 1e3, "position"},
      {"torque_bump", "bump_position", "rad", &T::bump_position, -10, 10, "position"},
      {"torque_bump", "bump_width", "rad", &T::bump_width, 1e-3, 10, "position"},
      {"dead_zone", "dead_torque", "N*m", &T::dead_torque, 0, 1e3, "command"},
      {"lost_load", "lost_load", "1", &T::lost_load, 0, 0.9, "two signals"},
      {"lost_load", "lost_time", "s", &T::lost_time, 0, 1e6, "two signals"},
      {"cubic_drag", "cubic_drag", "N*m*s3/rad3", &T::cubic_drag, 0, 1e3, "velocity"},
      {"eccentric_encoder", "eccentricity", "rad", &T::eccentricity, 0, 1, "position"},
      {"eccentric_encoder", "eccentricity_phase", "rad", &T::eccentricity_phase, -10, 10, "position"},
  };
  return entries;
}

Status HideEffects(const std::vector<std::pair<std::string, std::map<std::string, double>>>& effects,
                   const std::string& input, DriveTruth& truth) {
  const std::vector<DriveTruthEntry> entries = DriveTruthEntries(input);
  for (const auto& [effect, parameters] : effects) {
    std::vector<const DriveTruthEntry*> own;
    std::vector<std::string> names;
    for (const DriveTruthEntry& entry : entries) {
      if (entry.effect == effect) own.push_back(&entry);
      if (names.empty() || names.back() != entry.effect) names.push_back(entry.effect);
    }
    if (own.empty()) return Fail("--effect: '{}' does not exist{}", effect, Suggestion(effect, names));
    if (parameters.empty()) {
      return Fail("--effect {}: expected {}:{}=NUMBER", effect, effect, own.front()->parameter);
    }
    for (const auto& [parameter, value] : parameters) {
      const auto found = std::find_if(own.begin(), own.end(), [&, &name = parameter](const auto* entry) {
        return entry->parameter == name || (name == "value" && own.size() == 1);
      });
      if (found == own.end()) {
        std::vector<std::string> known;
        known.reserve(own.size());
        for (const auto* entry : own) known.push_back(entry->parameter);
        return Fail("--effect {}: '{}' does not exist{}", effect, parameter, Suggestion(parameter, known));
      }
      const DriveTruthEntry& entry = **found;
      if (!(value >= entry.lower && value <= entry.upper)) {
        return Fail("--effect {}:{}={}: expected {} to {} {}", effect, parameter, value,
                    Readable(entry.lower), Readable(entry.upper), entry.unit);
      }
      truth.*entry.value = value;
    }
  }
  return {};
}

}  // namespace sinew
