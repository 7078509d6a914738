// What a person decides about a drive: which channels are fitted, how the input is held, how finely it is
// integrated, and the controller of a closed loop.
//
//   drive:
//     fit: [position]          # of position, speed, torque, current; default: position, or else speed
//     hold: linear             # or zero: the input is constant from each sample to the next
//     step: 0.01               # [s] longest step of the integrator; default: chosen, see DriveProblem
//     controller:              # needed if the input is `reference`
//       kind: servo            # servo, pid_position or pid_speed
//       kp: 400                # numbers may also be constants of the data set or conditions of a trial
//       ki: 0                  #   (which win); ki, kd, control_period and output_limit are for pid_*
//       kd: 0                  #   kd acts on the change of the error, reference included
//       control_period: 0.001  # [s]
//       output: torque         # or voltage
//       output_limit: 5        # [N*m or V]
//       servo_error_gain: 0.00288  # [duty per rad and unit of kp]
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
  bool gives_voltage = false;             ///< of pid_*: its output is a voltage, not a torque
  std::map<std::string, double> numbers;  ///< those of the file, by name
};

struct DriveSettings {
  std::vector<std::string> fit;  ///< empty: position, or speed if there is none
  bool hold = false;             ///< the input is held between samples
  std::optional<double> step;    ///< [s]
  DriveControllerSettings controller;
};

/// The channels that a drive predicts, in the order of its blocks.
extern const std::vector<std::string> kDriveChannels;
/// Names of the controllers' numbers.
extern const std::vector<std::string> kDriveControllerNumbers;

/// @param yaml the map under the key `drive`. Errors: unknown keys, wrong values, each with file and line.
Result<DriveSettings> ReadDriveSettings(const YamlReader& yaml);

}  // namespace sinew
