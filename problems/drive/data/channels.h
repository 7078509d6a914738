// What a drive looks for in a data set: channels, and numbers that are constants or conditions of a trial.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "datasets/dataset.h"
#include "models/drive/drive.h"

namespace sinew {

/// The measured channel of that name, and its grid; nullptr (and the grid as it was): there is none.
const Channel* MeasuredIn(const Trial& trial, const std::string& name, const Grid** grid);

/// The input of that name, and its grid; nullptr (and the grid as it was): there is none.
const Channel* InputIn(const Trial& trial, const std::string& name, const Grid** grid);

/// How a signal is found in a data set.
struct DriveSignalChannel {
  DriveSignal signal;
  const char* name;  ///< of the input channel, the condition or the constant
  const char* unit;
  /// Only an effect needs it: used if every trial has the channel. Else it depends on the kind of the input.
  bool optional = false;
};
[[nodiscard]] const std::vector<DriveSignalChannel>& DriveSignalChannels();

/// Condition of a trial: when its time 0 was, since the begin of the session [s].
inline constexpr const char* kSessionTime = "session_time_s";

/// Inputs besides the command: what is added to the output of a sampled controller, and whether the motor is
/// on (1) or off (0: no torque, no current).
inline constexpr const char* kDisturbance = "disturbance";
inline constexpr const char* kMotorOn = "motor_on";

/// The name of the one input of a trial. Errors, to follow "trial 'x' ": none, or more than one.
Result<std::string> InputName(const Trial& trial);

std::optional<double> ConstantOf(const Dataset& data, const std::string& name);

/// A condition of the trial, else a constant.
std::optional<double> NumberOf(const Dataset& data, const Trial& trial, const std::string& name);

/// For `sinew list channels drive`.
std::string DescribeDriveChannels();

}  // namespace sinew
