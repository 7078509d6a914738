// What is true in the laboratory: the base parameters of a drive, everything that the library of effects
// knows, and things that it does not know. One table gives each its name.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"

namespace sinew {

/// Parameters of the simulated drive [SI, rotary]. Zero means absent unless another null is given. Names and
/// meanings of what the library knows are those of `sinew list effects drive`; the laws are written at
/// SimulateDrive.
struct DriveTruth {
  double inertia = 0.04;           // [kg*m2]
  double viscous_friction = 0.05;  // [N*m*s/rad]
  double gravity_torque = 0.6;     // [N*m]

  double coulomb_torque = 0;
  double forward_friction = 0;
  double backward_friction = 0;
  double stribeck_torque = 0;
  double stribeck_velocity = 0.1;
  double load_friction_coefficient = 0;
  double motor_load_friction = 0;
  double external_load_friction = 0;
  double stribeck_load_coefficient = 0;
  double stribeck_load_velocity = 0.1;
  double quadratic_load_coefficient = 0;
  double drag_coefficient = 0;
  double backlash_width = 0;
  double transmission_compliance = 0;
  double command_delay = 0;
  double sensing_delay = 0;
  double inverse_torque_limit = 0;
  double inverse_speed_limit = 0;
  double cogging_cos = 0;
  double cogging_sin = 0;
  double cogging_period = 1;
  double imbalance_torque = 0;
  double spring_stiffness = 0;
  double offset_torque = 0;
  double compression = 0;
  double thermal_rate = 0;
  double hold_fraction = 0;

  // The recorded input and the position reading.
  double input_offset = 0;
  double input_drift = 0;
  double input_gain = 1;
  double input_time_offset = 0;
  double input_low_pass = 0;
  double position_offset = 0;
  double position_drift = 0;
  double position_gain = 1;
  double position_time_offset = 0;
  double position_low_pass = 0;
  double position_saturation = 0;
  double position_quantisation = 0;

  // Outsiders: no effect of the library is any of these.
  double wear_rate = 0;            // [N*m/rad] Coulomb torque per distance travelled
  double tight_spot_torque = 0;    // [N*m] Coulomb torque at tight_spot_position, a bell of its width
  double tight_spot_position = 0;  // [rad]
  double tight_spot_width = 0.2;   // [rad]
  double shift_rate = 0;           // [N*m/s] growth of the gravity torque
  double hysteresis_torque = 0;    // [N*m] of a Dahl element
  double hysteresis_width = 0.2;   // [rad] travel after which it has turned over
  double clock_rate = 0;           // [1] the recorder's clock is slow by this fraction
  double damping_rate = 0;         // [N*m/rad] growth of the viscous friction per second
  double cubic_stiffness = 0;      // [N*m/rad3]
  double hum_torque = 0;           // [N*m] periodic in time
  double hum_frequency = 1;        // [Hz]
  double hum_phase = 0;            // [rad]
  double bump_torque = 0;          // [N*m] bell of position
  double bump_position = 0;        // [rad]
  double bump_width = 0.15;        // [rad]
  double dead_torque = 0;          // [N*m] commands below it do nothing; above, what exceeds it acts
  double lost_load = 0;            // [1] share of inertia and gravity that falls off at lost_time
  double lost_time = 5;            // [s]
  double cubic_drag = 0;           // [N*m*s3/rad3]
  double eccentricity = 0;         // [rad] reading + eccentricity sin(2 q + phase)
  double eccentricity_phase = 0;   // [rad]
};

/// A parameter of something hidden, its name, and where it lives.
struct DriveTruthEntry {
  std::string effect;
  std::string parameter;
  std::string unit;
  double DriveTruth::*value;
  double lower;
  double upper;
  /// Outsiders: on what the truth depends: "position", "velocity", "command", "time", "periodic in time",
  /// "two signals", "history". Empty for the effects of the library.
  std::string depends_on = {};
};

/// All of them; those of one effect are neighbours. Input sensors are named after the channel `input`
/// ("torque" or "reference").
[[nodiscard]] std::vector<DriveTruthEntry> DriveTruthEntries(const std::string& input);

/// Writes the parameters of `--effect NAME:PARAM=VALUE,...` into a truth; an effect of one parameter also
/// takes `value`. Errors: no such effect or parameter (with a suggestion), value out of range.
Status HideEffects(const std::vector<std::pair<std::string, std::map<std::string, double>>>& effects,
                   const std::string& input, DriveTruth& truth);

}  // namespace sinew
