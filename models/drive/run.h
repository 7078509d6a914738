// One trial as the integrator needs it: times from its begin, the input, and what is known of the controller.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "models/drive/drive.h"

namespace sinew {

/// A signal through a trial: straight between its samples, constant beyond them.
struct DriveSeries {
  std::vector<double> time;    ///< [L, s, increasing] empty: one number, or nothing
  std::vector<double> values;  ///< [L], or [1] if it is a number that is constant, or empty: not recorded
  std::vector<double> slope;   ///< [L - 1, 1/s] between the samples

  /// The slopes that belong to the samples.
  void SetSlopes() {
    slope.clear();
    for (std::size_t i = 0; i + 1 < time.size(); ++i)
      slope.push_back((values[i + 1] - values[i]) / (time[i + 1] - time[i]));
  }
};

/// Numbers of a controller in one trial.
struct DriveControllerGains {
  double kp = 0;
  double ki = 0;
  double kd = 0;  ///< acts on the change of the error, that of the reference included

  double position_gain = 0;             ///< [1/s] of a cascade: wanted speed per error of position
  double velocity_gain = 0;             ///< [N*m*s/rad or V*s/rad] output per error of speed
  double velocity_integral = 0;         ///< [N*m/rad or V/rad] output per integral of the error of speed
  double velocity_filter = 0;           ///< [s] of the differenced position; 0: none
  double velocity_feedforward = 0;      ///< [1] of the reference's speed
  double acceleration_feedforward = 0;  ///< [kg*m2 or V*s2/rad] output per acceleration of the reference
  double speed_limit = 0;               ///< [rad/s] of the wanted speed; 0: none

  double control_period = 0.001;  ///< [s]
  double output_limit = 0;        ///< [N*m or V] 0: none
  double servo_error_gain = 0;    ///< [1/rad per unit of kp]
};

struct DriveRun {
  std::string trial;
  double begin = 0;           ///< [s] time of the trial's t = 0; all other times count from it
  std::vector<double> stops;  ///< [S, s, increasing, first 0] where something is predicted

  std::vector<double> input_time;  ///< [K, s, increasing]
  std::vector<double> input;       ///< [K] recorded; constant before and after
  std::vector<double> slope;       ///< [K, 1/s] after each sample; 0 after the last, and if the input is held
  bool held = false;
  double input_noise = 0;   ///< [unit of the input] white, stated by the data; 0: none
  double input_cutoff = 0;  ///< [cycles per sample] above which it was smoothed; 0: it was not
  double middle = 0;        ///< [s] where the input sensor's drift is zero
  double session = 0;       ///< [s] of t = 0 since the begin of the session

  std::array<DriveSeries, kDriveSignals> signals;  ///< by DriveSignal; those that are needed are not empty
  DriveSeries disturbance;       ///< [N*m or V] added to the output of a sampled controller; empty: none
  bool on_at_begin = true;       ///< the motor
  std::vector<double> switches;  ///< [s, increasing, above 0] where it is switched off and on in turn
  DriveControllerGains gains;

  double initial_position = 0;  ///< starts of the nuisance values
  double initial_speed = 0;

  /// The slopes that belong to the input.
  void SetSlopes() {
    slope.assign(input.size(), 0);
    for (std::size_t i = 0; !held && i + 1 < input.size(); ++i)
      slope[i] = (input[i + 1] - input[i]) / (input_time[i + 1] - input_time[i]);
  }

  /// Whether the motor is on from t on.
  [[nodiscard]] bool OnAt(double t) const {
    const auto passed = std::upper_bound(switches.begin(), switches.end(), t) - switches.begin();
    return on_at_begin == (passed % 2 == 0);
  }
};

/// What is alike in all trials.
struct DriveCommand {
  DriveInput input = DriveInput::kTorque;
  DriveControllerKind controller = DriveControllerKind::kNone;
  double step = 0.01;        ///< [s] longest step
  double most_steps = 1000;  ///< of the integrator between two stops: a simulation that needs more has failed
  double most_position = 1e6;  ///< a motion beyond these has left the model's world
  double most_speed = 1e6;

  [[nodiscard]] bool sampled() const {
    return controller == DriveControllerKind::kPidSpeed || controller == DriveControllerKind::kPidPosition ||
           controller == DriveControllerKind::kCascade;
  }
};

}  // namespace sinew
