// A joint and its drive as a laboratory would have them on the bench: the truth of synthetic data. Shares no
// code with the model that is fitted.
//
// Scheme: time stepping at velocity level after Moreau. In each step the position moves half a step with the
// old speed, forces act there for the whole step (viscous ones by the trapezoidal rule), dry friction is the
// impulse that brings the speed nearest to zero without exceeding its limit (a projection: stiction is exact,
// nothing is smoothed), and the position moves another half step with the new speed. Second order while
// sliding. Source: Moreau, Unilateral contact and dry friction in finite freedom dynamics (1988); Acary,
// Brogliato, Numerical methods for nonsmooth dynamical systems (2008), ch. 10.
#pragma once

#include <optional>
#include <vector>

#include "base/constants.h"
#include "base/error.h"
#include "base/linear_algebra.h"
#include "problems/drive/laboratory/truth.h"

namespace sinew {

/// What makes the torque of a trial out of its command.
enum class DriveControl {
  kTorque,    ///< the command is the torque
  kTracking,  ///< a controller follows the command (positions); the torque it asked for is the recorded input
  kPidSpeed,  ///< the command (speeds) goes to a sampled PID speed controller, which the fitted model
              ///< contains
  kCascade    ///< the command (positions) goes to a sampled cascade, which the fitted model contains
};

/// Position controller around a speed controller, as a drive amplifier has it.
struct DriveCascade {
  double position_gain = 0;             ///< [1/s]
  double velocity_gain = 0;             ///< [N*m*s/rad]
  double velocity_integral = 0;         ///< [N*m/rad]
  double velocity_filter = 0;           ///< [s]
  double velocity_feedforward = 0;      ///< [1]
  double acceleration_feedforward = 0;  ///< [kg*m2]
  double speed_limit = 0;               ///< [rad/s] 0: none
};

struct DriveController {
  double kp = 0;
  double ki = 0;
  double kd = 0;
  double control_period = 0.01;  ///< [s], of kPidSpeed and kCascade
  double output_limit = 0;       ///< [N*m], of kPidSpeed and kCascade
};

/// How the joint warms up while it works; its own temperature is that of the room.
struct DriveWarming {
  double rise = 0;           ///< [K] after a long time
  double time_constant = 1;  ///< [s]
  double worked = 0;         ///< [s] before the trial's first sample

  /// @param t since the trial's first sample [s] @return [K]
  [[nodiscard]] double At(double t) const;
};

/// One trial: the command is straight between samples and constant beyond them.
struct DriveTrial {
  std::vector<double> command;  ///< [N] at k / rate
  double rate = 100;            ///< [Hz]
  DriveControl control = DriveControl::kTorque;
  DriveController controller;
  DriveCascade cascade;             ///< of kCascade, with the period and the limit of the controller
  std::vector<double> disturbance;  ///< [N or 0, N*m] of kCascade: added to its output before the limit
  std::vector<double> motor_on;     ///< [N or 0] 0 from a sample on: the motor gives no torque
  double initial_position = 0;      ///< [rad], kDriveLead before the first sample
  double initial_speed = 0;         ///< [rad/s]
  double command_scale = 1;  ///< [N*m] largest magnitude of the commands of all trials, for compression
  DriveWarming warming;
  double session = 0;  ///< [s] of the first sample, since the begin of the session
};

inline constexpr double kDegree = kPi / 180;
/// [s] The joint moves before the recording begins (and a little after its end).
inline constexpr double kDriveLead = 0.3;
/// [s] A step that is far finer than anything that happens, and one for signatures.
inline constexpr double kFineStep = 2e-4;
inline constexpr double kSignatureStep = 1e-3;
/// [s] Where small differences grow: for both, or they would belong to different motions.
inline constexpr double kOverTheTopStep = 1e-5;

/// What the instruments would show without noise, before the position reading is clipped or rounded.
struct DriveRecord {
  Vector input;        ///< [N] the recorded input (torque or reference), with the effects of its sensor
  Vector position;     ///< [N, rad] with the effects of its sensor
  Vector speed;        ///< [N, rad/s] of the joint
  Vector torque;       ///< [N, N*m] of the drive
  Vector temperature;  ///< [N, K] of the joint
};

/// Simulates a trial.
///
///   M dv/dt = tau - gravity sin q - viscous v - dry friction - further terms,   dq/dt = v
///
/// Viscous friction changes by the factor exp(friction_temperature_coefficient (temperature - 293.15 K)).
/// viscous_asymmetry adds to it forwards and is subtracted backwards.
/// Dry friction F(q, v, load) sign v, load = |tau + gravity sin q| / 2, is the sum of coulomb, forward or
/// backward, stribeck exp(-(v / vs)^2), load and directional parts. tau is the command late by command_delay,
/// blended towards its last sample by hold_fraction, without dead_zone_width, times (1 - compression |u| /
/// command_scale)(1 - thermal_rate t)(1 + warm_up_gain (1 - exp(-t / warm_up_time)))(1 + session_rate
/// (session
/// + t)), clipped at 1 / inverse_torque_limit, and in the direction of motion
/// reduced to zero between 0.9 and 1.0 of the speed limit. The reading is q + compliance tau, behind a play
/// of backlash_width. A recorded instrument shows gain * low_pass(x(t - time_offset)) + offset + drift (t -
/// middle).
/// @param step [s] about; a whole number of steps fits between two samples.
/// Errors: the motion is not finite.
Result<DriveRecord> SimulateDrive(const DriveTruth& truth, const DriveTrial& trial, double step);

/// The position reading of an instrument that saturates and rounds: what comes after noise.
void ReadPosition(const DriveTruth& truth, Vector& position);

}  // namespace sinew
