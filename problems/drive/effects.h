// The parameters of a drive and everything that might be wrong with it: one place for names, units, ranges,
// nulls, sentences and experiments. Where an effect enters the motion is in models/drive/dynamics.h and
// models/drive/integrator.h.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "models/drive/drive.h"
#include "problems/kit/parameter_list.h"

namespace sinew {

/// Size of things in the data: ranges of parameters are multiples of these.
struct DriveScales {
  double torque = 1;         ///< [N*m] largest drive torque
  double speed = 1;          ///< [rad/s] largest
  double position = 1;       ///< [rad] width of the range
  double lowest = -0.5;      ///< [rad]
  double highest = 0.5;      ///< [rad]
  double command = 1;        ///< largest magnitude of the input
  double motor_command = 1;  ///< about the largest magnitude of what reaches the motor, in its own unit
  double lowest_command = -1;
  double highest_command = 1;
  double samples = 4000;  ///< readings of the position
  double duration = 10;   ///< [s] of the longest trial
  double shortest = 10;   ///< [s] of the shortest
  double session = 0;   ///< [s] of all trials and the time between them, if they say when they were recorded
  double noise = 1e-3;  ///< [rad] of the position, or a hundredth of its spread if it is not stated
};

/// What decides which parameters there are.
struct DriveTraits {
  bool rotary = true;
  bool electric = false;
  bool load_known = false;
  double load_inertia = 0;  ///< [kg*m2] of the known load
  DriveInput input = DriveInput::kTorque;
  DriveControllerKind controller = DriveControllerKind::kNone;
  bool held = false;                ///< the input is held between samples
  bool compressible = true;         ///< the largest command of the drive is known
  bool integral_is_fitted = false;  ///< the controller's integral at the begin of each trial
  bool session = false;             ///< every trial says when in a session it was recorded
  std::string input_channel = "torque";
  std::string input_unit = "N*m";
  std::array<bool, kDriveSignals> signals{};             ///< by DriveSignal: the model has a use for it
  std::optional<double> pole_period;                     ///< [rad] of the joint per pole of the motor
  std::array<std::optional<double>, kDriveSlots> fixed;  ///< base parameters that are known
};

/// Starts of the base parameters, by slot.
using DriveStarts = std::array<double, kCoulombTorque>;

/// Shared parameters by DriveSlot; nuisance values follow them.
struct DriveParameterList : ParameterList {
  std::array<double, kDriveSlots> resting{};  ///< number of a slot that has no parameter
};

[[nodiscard]] DriveParameterList ListDriveParameters(const DriveTraits& traits, const DriveScales& scales,
                                                     const DriveStarts& starts);

}  // namespace sinew
