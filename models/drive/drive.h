// The drive: one actuated joint, rotary or linear, with a load that may hang on it.
//
//   M dv/dt = tau(command) - gravity(q) - viscous_friction v - friction(q, v, loads) + further terms
//   dq/dt   = v
//
// q is the position [rad or m], v the speed, M = inertia (+ load_mass load_length^2 if both constants are
// known). A rotary joint hangs down at q = 0: gravity(q) = gravity_torque sin q, or, with a known load,
// load_mass 9.80665 load_length sin q. A linear axis has none, unless the constant incline_force [N] is
// given. What a joint does at v = 0 is exact: it sticks as long as the break-away friction holds the applied
// torque.
//
// The command is one input channel:
//   torque, force   tau = drive_gain u
//   voltage         tau = N torque_constant i,  i = (u - N torque_constant v) / resistance
//   duty            like voltage, u = duty supply_voltage
//   reference       of a known controller (problems/drive/settings.h), whose output is a torque, a voltage or
//   a duty
// with N = gear_ratio (1 if not given). The units below are those of a rotary joint; a linear axis has N for
// N*m, kg for kg*m2, m for rad.
//
//   inertia           kg*m2      logarithmic        moving inertia at the joint (without the known load)
//   viscous_friction  N*m*s/rad  >= 0
//   gravity_torque    N*m        either sign        unless the load is known
//   drive_gain        1          >= 0               torque input with a known load; else the scale is not
//                                                   determined, and it is 1
//   torque_constant   N*m/A      logarithmic        electric drives
//   resistance        ohm        logarithmic        electric drives with a known load; else 1 ohm: without a
//                                                   known load no motion tells the scale
//   initial_position@TRIAL, initial_speed@TRIAL     nuisance: state at the first time that is predicted
//   initial_integral@TRIAL  N*m or V               nuisance, if asked for: output of the controller's
//   integral
// A constant of the data set with the name of a base parameter fixes it. Effects are listed in
// problems/drive/effects.cpp.
//
// Sources: Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083-1138 (friction); Tao &
// Kokotovic, Adaptive Control of Systems with Actuator and Sensor Nonlinearities (1996) (play); Duclusaud et
// al., Extended friction models for the physics simulation of servo actuators (2024) (load-dependent
// friction).
#pragma once

#include <array>
#include <string>

namespace sinew {

/// Everything that can be a number of the joint, in the order of the parameters of DriveProblem (which leaves
/// out what does not apply).
enum DriveSlot : int {
  // Base.
  kInertia,
  kViscousFriction,
  kGravityTorque,
  kDriveGain,
  kTorqueConstant,
  kResistance,
  // Dry friction.
  kCoulombTorque,
  kForwardFriction,
  kBackwardFriction,
  kStribeckTorque,
  kStribeckVelocity,
  kLoadFriction,
  kMotorLoadFriction,
  kExternalLoadFriction,
  kStribeckLoad,
  kStribeckLoadVelocity,
  kQuadraticLoad,
  // Other torques.
  kFrictionTemperature,
  kViscousAsymmetry,
  kDrag,
  kCoggingCos,
  kCoggingSin,
  kCoggingPeriod,
  kImbalance,
  kInertiaError,
  kSpring,
  kCubicStiffness,
  kOffsetTorque,
  // Drive.
  kDeadZone,
  kInverseTorqueLimit,
  kInverseSpeedLimit,
  kCompression,
  kThermalRate,
  kWarmUpGain,
  kWarmUpTime,
  kSessionRate,
  kResistanceRate,
  // Timing and transmission.
  kCommandDelay,
  kSensingDelay,
  kActuationDelay,
  kHoldFraction,
  kBacklash,
  kCompliance,
  // Sensor of the input.
  kInputOffset,
  kInputGain,
  kInputDrift,
  kInputTimeOffset,
  kInputLowPass,
  // Unknown terms, a slot per knot.
  kFirstTerm,
  // State at the begin.
  kInitialPosition = kFirstTerm + 80,
  kInitialSpeed,
  kInitialIntegral,  // of a sampled controller
  kDriveSlots
};
/// Unknown terms: curves of one signal that add to the torque on the joint, to its dry friction, which is a
/// level >= 0 that opposes the motion, or to its viscous friction.
enum DriveTerm : int {
  kTorqueOfPosition,
  kTorqueOfVelocity,
  kTorqueOfCommand,
  kTorqueOfTime,
  kFrictionOfPosition,
  kFrictionOfTime,
  kDampingOfTime,
  kTerms
};
/// Knots of each. A place that binds may be narrow against the range of motion.
inline constexpr std::array<int, kTerms> kTermKnots{24, 8, 8, 8, 16, 8, 8};
inline constexpr std::array<int, kTerms + 1> kTermSlots{kFirstTerm,      kFirstTerm + 24, kFirstTerm + 32,
                                                        kFirstTerm + 40, kFirstTerm + 48, kFirstTerm + 64,
                                                        kFirstTerm + 72, kInitialPosition};

/// What the command is.
enum class DriveInput { kTorque, kVoltage, kDuty, kReference };

/// What is recorded of a trial besides its input, and enters the motion.
enum DriveSignal : int {
  kSupplyVoltage,  ///< [V] of duty and servo
  kTemperature,    ///< [K] of the joint
  kDriveSignals
};

/// Of the joint [K], at which viscous friction is `viscous_friction`.
inline constexpr double kReferenceTemperature = 293.15;

/// Who turns a reference into a command.
enum class DriveControllerKind { kNone, kPidSpeed, kPidPosition, kCascade, kServo };

}  // namespace sinew
