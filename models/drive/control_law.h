// What a sampled controller computes at a tick, on double or on dual numbers. It does not depend on the
// joint, so that the measured motion can be put through it as well.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/dual.h"
#include "models/drive/run.h"

namespace sinew {

/// What a controller gets at a tick.
template <class T>
struct DriveTick {
  T reference{0};
  T seen{0};         ///< position, or of pid_speed the speed, as it is fed back
  T speed{0};        ///< of the joint; a cascade needs it at the first tick
  T disturbance{0};  ///< [N*m or V] added to the output before it is limited
  bool on = true;    ///< the motor
};

/// Ticks, one after the other:
///
///   pid_*    e = reference - seen,  output = kp e + ki I + kd (e - e_before) / period,  I = period sum(e)
///   cascade  w = position_gain (reference - seen) + velocity_feedforward reference',  at most speed_limit
///            e = w - velocity,  output = velocity_gain e + velocity_integral I + acceleration_feedforward
///            reference'',  velocity += period / (velocity_filter + period) ((seen - seen_before) / period -
///            velocity)
///
/// reference' and reference'' are differences from tick to tick, 0 until there are two or three. The velocity
/// begins with that of the joint. A disturbance is added; then output_limit clips the sum, and the integral
/// does not grow further into the limit. While the motor is off the output and the integral are 0.
template <class T>
class DriveControlLaw {
 public:
  /// @param integral output of the integral at the begin [N*m or V]. @param gains must outlive this.
  DriveControlLaw(DriveControllerKind kind, const DriveControllerGains& gains, const T& integral)
      : cascade_(kind == DriveControllerKind::kCascade),
        gains_(gains),
        integral_gain_(cascade_ ? gains.velocity_integral : gains.ki) {
    if (integral_gain_ != 0) integral_ = integral * (1 / integral_gain_);
  }

  [[nodiscard]] T Output(const DriveTick<T>& now) {
    T error(0);
    T output = cascade_ ? Cascade(now, error) : Pid(now, error);
    ++ticks_;
    if (!now.on) {
      integral_ = T(0);
      return T(0);
    }
    const T grown = integral_ + gains_.control_period * error;
    output += integral_gain_ * grown;
    output += now.disturbance;
    const double limit = gains_.output_limit;
    const bool clipped = limit > 0 && std::abs(Value(output)) > limit;
    if (clipped) output = T(Value(output) > 0 ? limit : -limit);
    // Anti-windup by conditional integration: the integral never grows further into the limit.
    if (!clipped || Value(output) * Value(error) * integral_gain_ <= 0) integral_ = grown;
    return output;
  }

 private:
  // Both without the integral. @param error what the integral adds up
  T Pid(const DriveTick<T>& now, T& error) {
    error = now.reference - now.seen;
    T output = gains_.kp * error;
    if (ticks_ > 0) output += (gains_.kd / gains_.control_period) * (error - last_error_);
    last_error_ = error;
    return output;
  }

  T Cascade(const DriveTick<T>& now, T& error) {
    const double per_period = 1 / gains_.control_period;
    const double share = gains_.control_period / (gains_.velocity_filter + gains_.control_period);
    velocity_ =
        ticks_ == 0 ? now.speed : velocity_ + share * (per_period * (now.seen - last_seen_) - velocity_);
    const T rate = ticks_ == 0 ? T(0) : per_period * (now.reference - last_reference_);
    T wanted = gains_.position_gain * (now.reference - now.seen) + gains_.velocity_feedforward * rate;
    const double limit = gains_.speed_limit;
    if (limit > 0 && std::abs(Value(wanted)) > limit) wanted = T(Value(wanted) > 0 ? limit : -limit);
    error = wanted - velocity_;
    T output = gains_.velocity_gain * error;
    if (ticks_ > 1) output += (gains_.acceleration_feedforward * per_period) * (rate - last_rate_);
    last_seen_ = now.seen;
    last_reference_ = now.reference;
    last_rate_ = rate;
    return output;
  }

  bool cascade_;
  const DriveControllerGains& gains_;
  double integral_gain_;
  long ticks_ = 0;
  T integral_{0};
  T last_error_{0};
  T velocity_{0};
  T last_seen_{0};
  T last_reference_{0};
  T last_rate_{0};
};

}  // namespace sinew
