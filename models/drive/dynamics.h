// The equation of motion of drive.h, on double or on dual numbers.
//
// An effect whose parameters are all at their null and that are not differentiated is skipped; evaluated, it
// adds exactly zero. So the value is the same to the last bit, whatever is differentiated.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "base/dual.h"
#include "base/linear_basis.h"
#include "models/drive/drive.h"

namespace sinew {

/// What is known of a joint and never fitted.
struct DriveJoint {
  bool rotary = true;
  bool electric = false;  ///< the command that reaches the motor is a voltage
  bool load_known = false;
  double load_inertia = 0;   ///< [kg*m2] of the known load
  double load_gravity = 0;   ///< [N*m] of the known load, times sin q
  double incline_force = 0;  ///< [N] of a linear axis
  double gear_ratio = 1;
  double largest_command = 1;  ///< of all trials, for compression
  double largest_torque =
      1;  ///< [N*m] about, of all trials; this and the next two decide only how fine steps are
  double largest_speed = 1;     ///< [rad/s]
  double largest_position = 1;  ///< [rad] from 0
  /// Of the unknown terms; terms without knots do not exist.
  std::array<std::vector<double>, kTerms> knots;
};

/// Which effects must be evaluated: those that are not at their null, or that are differentiated.
struct DriveUses {
  std::array<bool, kDriveSlots> slot{};
  std::array<bool, kTerms> term{};
  bool dry_friction = false;
  bool input_sensor = false;

  [[nodiscard]] bool operator[](int s) const { return slot[static_cast<std::size_t>(s)]; }
  /// A controller sees the joint as it was.
  [[nodiscard]] bool feedback_is_late() const { return slot[kSensingDelay] || slot[kActuationDelay]; }
  [[nodiscard]] bool unknown_friction() const { return term[kFrictionOfPosition] || term[kFrictionOfTime]; }
};

/// The joint with numbers for everything; T is double or Dual<N>.
template <class T>
class DriveDynamics {
 public:
  /// Drive torque falls to zero over this last share of the speed limit.
  static constexpr double kSpeedFade = 0.1;
  using Numbers = std::array<T, kDriveSlots>;

  /// @param frictional some dry friction is above zero. @param joint must outlive this.
  DriveDynamics(const DriveJoint& joint, const Numbers& numbers, const DriveUses& uses, bool frictional)
      : joint_(&joint), numbers_(numbers), uses_(uses), frictional_(frictional) {
    inverse_mass_ = 1.0 / (numbers_[kInertia] + joint.load_inertia + numbers_[kInertiaError]);
    if (joint.electric) {
      torque_per_volt_ = joint.gear_ratio * numbers_[kTorqueConstant] / numbers_[kResistance];
      volts_per_speed_ = joint.gear_ratio * numbers_[kTorqueConstant];
    }
  }

  [[nodiscard]] const T& operator[](int slot) const { return numbers_[static_cast<std::size_t>(slot)]; }
  [[nodiscard]] const Numbers& numbers() const { return numbers_; }
  [[nodiscard]] const DriveJoint& joint() const { return *joint_; }
  [[nodiscard]] const DriveUses& uses() const { return uses_; }
  [[nodiscard]] bool frictional() const { return frictional_; }
  [[nodiscard]] const T& inverse_mass() const { return inverse_mass_; }

  /// How late a controller's feedback acts, and the input [s]. A controller whose output is late acts on what
  /// was wanted and seen that long ago.
  [[nodiscard]] T AgeOfFeedback() const { return numbers_[kSensingDelay] + numbers_[kActuationDelay]; }
  [[nodiscard]] T ShiftOfInput() const {
    return numbers_[kCommandDelay] + numbers_[kActuationDelay] - numbers_[kInputTimeOffset];
  }

  /// Torques that act on the joint, dry friction aside.
  struct Loads {
    T drive;                            ///< tau
    T gravity;                          ///< gravity(q)
    T applied;                          ///< sum of all of them
    std::optional<T> unknown_friction;  ///< dry friction of the unknown terms, >= 0, if one is in use
  };

  /// Current [A] of an electric drive under a voltage. @param t since the trial's begin [s]
  template <class Time>
  [[nodiscard]] T Current(const T& voltage, const T& v, const Time& t) const {
    return Warmed(OverBackEmf(voltage, v) / numbers_[kResistance], t);
  }

  /// Change of gain of whatever the command is: dead zone, compression, and what changes with time.
  /// @param acting the command. @param t since the trial's begin [s]. @param session of the trial's begin,
  /// since that of the session [s]
  template <class Time>
  void Weaken(T& acting, const Time& t, double session) const {
    if (uses_[kDeadZone] || uses_[kCompression]) {
      const T command = acting;
      if (uses_[kDeadZone]) {
        const T beyond = Abs(command) - numbers_[kDeadZone];
        acting = Value(beyond) <= 0 ? T(0) : Value(command) > 0 ? beyond : -beyond;
      }
      if (uses_[kCompression]) {
        acting = acting * (1.0 - numbers_[kCompression] * (Abs(command) * (1 / joint_->largest_command)));
      }
    }
    if (uses_[kThermalRate]) acting = acting * (1.0 - numbers_[kThermalRate] * t);
    if (uses_[kWarmUpGain]) {
      const T left = Exp(-(t / numbers_[kWarmUpTime]));
      acting = acting * (1.0 + numbers_[kWarmUpGain] * (1.0 - left));
    }
    if (uses_[kSessionRate]) acting = acting * (1.0 + numbers_[kSessionRate] * (session + t));
  }

  /// tau for a torque or voltage that reaches the motor. @param t since the trial's begin [s]
  template <class Time>
  [[nodiscard]] T DriveTorque(const T& command, const T& v, const Time& t) const {
    T tau = joint_->electric ? Warmed(torque_per_volt_ * OverBackEmf(command, v), t)
                             : numbers_[kDriveGain] * command;
    if (uses_[kInverseTorqueLimit]) {
      const T& x = numbers_[kInverseTorqueLimit];
      if (std::abs(Value(tau)) * Value(x) > 1) tau = (Value(tau) > 0 ? 1.0 : -1.0) / x;
    }
    if (uses_[kInverseSpeedLimit] && Value(tau) * Value(v) > 0) {
      const T left = 1.0 - Abs(v) * numbers_[kInverseSpeedLimit];  // share of the limit
      if (Value(left) <= 0) {
        tau = T(0);
      } else if (Value(left) < kSpeedFade) {
        tau = tau * (left * (1 / kSpeedFade));
      }
    }
    return tau;
  }

  /// @param drive torque of the drive. @param signal gives the command as the port sees it, and
  /// @param recorded the value of a DriveSignal, both at t; asked only for what an effect in use needs.
  /// @param t since the trial's begin [s]
  template <class Time, class Signal, class Recorded>
  [[nodiscard]] Loads LoadsAt(const T& drive, const Signal& signal, const Recorded& recorded, const Time& t,
                              const T& q, const T& v) const {
    Loads loads{drive, Gravity(q), drive, std::nullopt};
    T& sum = loads.applied;
    sum -= loads.gravity;
    const T& viscous = numbers_[kViscousFriction];
    if (uses_[kFrictionTemperature]) {
      const T change = Exp(numbers_[kFrictionTemperature] * (recorded(kTemperature) - kReferenceTemperature));
      SubtractProduct(sum, viscous * change, v);
    } else {
      SubtractProduct(sum, viscous, v);
    }
    if (uses_[kViscousAsymmetry]) SubtractProduct(sum, numbers_[kViscousAsymmetry], Abs(v));
    if (uses_[kDrag]) SubtractProduct(sum, numbers_[kDrag], v * Abs(v));
    if (uses_[kCoggingCos] || uses_[kCoggingSin]) {
      const T angle = q * (2 * kPi) / numbers_[kCoggingPeriod];
      T ripple = numbers_[kCoggingCos] * Cos(angle);
      AddProduct(ripple, numbers_[kCoggingSin], Sin(angle));
      sum += ripple;
    }
    if (uses_[kImbalance]) SubtractProduct(sum, numbers_[kImbalance], Cos(q));
    if (uses_[kSpring]) SubtractProduct(sum, numbers_[kSpring], q);
    if (uses_[kCubicStiffness]) SubtractProduct(sum, numbers_[kCubicStiffness], q * q * q);
    if (uses_[kOffsetTorque]) sum += numbers_[kOffsetTorque];
    if (uses_.term[kTorqueOfPosition]) AddTerm(kTorqueOfPosition, q, sum);
    if (uses_.term[kTorqueOfVelocity]) AddTerm(kTorqueOfVelocity, v, sum);
    if (uses_.term[kTorqueOfCommand]) AddTerm(kTorqueOfCommand, signal(), sum);
    if (uses_.term[kTorqueOfTime]) AddTerm(kTorqueOfTime, t, sum);
    if (uses_.term[kDampingOfTime]) {
      T damping(0);
      AddTerm(kDampingOfTime, t, damping);
      SubtractProduct(sum, damping, v);
    }
    if (uses_.unknown_friction()) {
      T& friction = loads.unknown_friction.emplace(0);
      if (uses_.term[kFrictionOfPosition]) AddTerm(kFrictionOfPosition, q, friction);
      if (uses_.term[kFrictionOfTime]) AddTerm(kFrictionOfTime, t, friction);
    }
    return loads;
  }

  /// Dry friction that opposes motion into `direction` (+1 or -1) at v: >= 0. At v = 0 the break-away value.
  [[nodiscard]] T Friction(double direction, const T& v, const Loads& loads) const {
    T level = uses_[kCoulombTorque] ? numbers_[kCoulombTorque] : T(0);
    const int one_sided = direction > 0 ? kForwardFriction : kBackwardFriction;
    if (uses_[one_sided]) level += (*this)[one_sided];
    if (uses_[kStribeckTorque]) AddProduct(level, numbers_[kStribeckTorque], Stribeck(v, kStribeckVelocity));
    if (uses_[kLoadFriction] || uses_[kStribeckLoad] || uses_[kQuadraticLoad]) {
      const T load = 0.5 * Abs(loads.drive + loads.gravity);
      if (uses_[kLoadFriction]) AddProduct(level, numbers_[kLoadFriction], load);
      if (uses_[kStribeckLoad])
        AddProduct(level, numbers_[kStribeckLoad], load * Stribeck(v, kStribeckLoadVelocity));
      if (uses_[kQuadraticLoad]) AddProduct(level, numbers_[kQuadraticLoad], load * load);
    }
    if (uses_[kMotorLoadFriction]) AddProduct(level, numbers_[kMotorLoadFriction], Abs(loads.drive));
    if (uses_[kExternalLoadFriction]) AddProduct(level, numbers_[kExternalLoadFriction], Abs(loads.gravity));
    if (loads.unknown_friction) level += *loads.unknown_friction;
    return level;
  }

  /// dv/dt while sliding into `direction`; 0 leaves dry friction out.
  [[nodiscard]] T Acceleration(double direction, const T& v, const Loads& loads) const {
    if (!uses_.dry_friction || direction == 0) return loads.applied * inverse_mass_;
    T net = loads.applied;
    AddProduct(net, -direction, Friction(direction, v, loads));
    return net * inverse_mass_;
  }

 private:
  static constexpr double kPi = 3.14159265358979323846;

  [[nodiscard]] T Gravity(const T& q) const {
    if (!joint_->rotary) return T(joint_->incline_force);
    if (joint_->load_known) return joint_->load_gravity * Sin(q);
    return numbers_[kGravityTorque] * Sin(q);
  }

  [[nodiscard]] T OverBackEmf(const T& voltage, const T& v) const {
    T over = voltage;
    SubtractProduct(over, volts_per_speed_, v);
    return over;
  }

  // A current [A], or what is proportional to it, through a winding whose resistance changes with time.
  template <class Time>
  [[nodiscard]] T Warmed(const T& current, const Time& t) const {
    return uses_[kResistanceRate] ? current / (1.0 + numbers_[kResistanceRate] * t) : current;
  }

  [[nodiscard]] T Stribeck(const T& v, int velocity) const {
    const T ratio = v / (*this)[velocity];
    return Exp(-(ratio * ratio));
  }

  template <class X>
  void AddTerm(int term, const X& x, T& sum) const {
    const LinearBasis basis = LinearBasisAt(joint_->knots[static_cast<std::size_t>(term)], Value(x));
    const int slot = kTermSlots[static_cast<std::size_t>(term)] + basis.first;
    const T& left = (*this)[slot];
    AddProduct(sum, basis.left, left);
    if (basis.left_slope == 0) return;
    const T& right = (*this)[slot + 1];
    AddProduct(sum, basis.right, right);
    sum += (basis.left_slope * (Value(left) - Value(right))) * Tangent(x);
  }

  const DriveJoint* joint_;
  Numbers numbers_;
  DriveUses uses_;
  bool frictional_;
  T inverse_mass_;
  T torque_per_volt_{0};
  T volts_per_speed_{0};
};

}  // namespace sinew
