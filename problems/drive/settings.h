// What a person decides about a drive: which channels are fitted, how the input is held, how finely it is
// integrated, and the controller of a closed loop.
//
//   drive:
//     fit: [position]          # of position, speed, torque, current; default: position, or else speed
//     hold: linear             # or zero: the input is constant from each sample to the next
//     step: 0.01               # [s] longest step of the integrator; default: chosen, see DriveProblem
//     most_steps: 1000         # of the integrator between two samples: a simulation that needs more has
//     failed controller:              # needed if the input is `reference`
//       kind: servo            # servo, pid_position, pid_speed or cascade; numbers may also be constants of
//                              #   the data set or conditions of a trial (which win)
//       kp: 400                # of servo and pid_*
//       servo_error_gain: 0.00288  # [duty per rad and unit of kp], of servo
//       ki: 0                  # of pid_*
//       kd: 0                  # of pid_*; acts on the change of the error, reference included
//       position_gain: 12      # [1/s], of cascade, as all that follow but the last four
//       velocity_gain: 1.5     # [N*m*s/rad or V*s/rad]
//       velocity_integral: 10  # [N*m/rad or V/rad]; 0 (default): P/P, else P/PI
//       velocity_filter: 0.002 # [s] of the differenced position; default 0
//       velocity_feedforward: 1         # [1] default 0
//       acceleration_feedforward: 0.04  # [kg*m2 or V*s2/rad] default 0
//       speed_limit: 3         # [rad/s] of the wanted speed; 0 (default): none
//       control_period: 0.001  # [s] of pid_* and cascade, as what follows
//       output: torque         # or voltage
//       output_limit: 5        # [N*m or V] 0 (default): none
//       initial_integral: zero # at the begin of a trial; fitted: one more nuisance value per trial
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/yaml_reader.h"
#include "models/drive/drive.h"

namespace sinew {

struct DriveControllerSettings {
  DriveControllerKind kind = DriveControllerKind::kNone;
  bool gives_voltage = false;             ///< of a sampled controller: its output is a voltage, not a torque
  bool integral_is_fitted = false;        ///< its integral at the begin of a trial, else 0
  std::map<std::string, double> numbers;  ///< those of the file, by name
};

struct DriveSettings {
  std::vector<std::string> fit;  ///< empty: position, or speed if there is none
  bool hold = false;             ///< the input is held between samples
  std::optional<double> step;    ///< [s]
  double most_steps = 1000;      ///< of the integrator between two samples
  DriveControllerSettings controller;
};

/// The channels that a drive predicts, in the order of its blocks.
extern const std::vector<std::string> kDriveChannels;
/// Names of the controllers' numbers.
extern const std::vector<std::string> kDriveControllerNumbers;

/// @param yaml the map under the key `drive`. Errors: unknown keys, wrong values, each with file and line.
Result<DriveSettings> ReadDriveSettings(const YamlReader& yaml);

}  // namespace sinew
