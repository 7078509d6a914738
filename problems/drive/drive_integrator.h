// Integrates the joint through one trial, with exact sensitivities if T is Dual<N>.
//
// Classical Runge-Kutta of order 4. Steps end where something is discontinuous: at samples of the input (as
// shifted by command_delay and time_offset), at ticks of a sampled controller, and at reversals. Where such
// an instant depends on parameters, time itself is a dual number, which is what saltation matrices are made
// of.
//
// Dry friction is a set-valued law: the joint slips in one direction until its speed is zero, which is
// located by root finding; there it sticks if the break-away friction holds the applied torque, else it slips
// into the direction of that torque; it breaks away at the instant when the torque exceeds the friction,
// located too. Without friction the same zeros are located (so that no value depends on whether friction is
// differentiated) and nothing happens there.
//
// Kinks that are no jumps (limits of torque, speed and servo duty; hats of unknown terms in q and v) are not
// located: the order drops there to 2 locally, the derivatives remain those of the discrete map.
#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <vector>

#include "base/error.h"
#include "problems/drive/drive_dynamics.h"
#include "problems/drive/drive_run.h"

namespace sinew {

/// What is predicted at one time.
template <class T>
struct DriveSample {
  T position;  ///< as seen: behind play and wind-up
  T speed;
  T torque;
  T current;
};

/// Feedback that a sampled controller has seen, a ring over its ticks.
template <class T>
using DriveHistory = std::vector<T>;

template <class T>
class DriveIntegrator {
 public:
  /// @param history scratch of the size DriveHistorySize. @param rate [1/s] of the fastest thing that can
  /// happen at speeds as they were measured: steps are at most its inverse, and shorter at higher speeds.
  DriveIntegrator(const DriveCommand& command, const DriveRun& run, const DriveDynamics<T>& dynamics,
                  const DriveDynamics<double>& plain, double rate, DriveHistory<T>& history)
      : command_(command),
        run_(run),
        dynamics_(dynamics),
        plain_(plain),
        rate_(std::max(rate, 1 / command.step)),
        drag_rate_(2 * plain[kDrag] * plain.inverse_mass()),
        history_(history),
        shift_(Tangent(dynamics[kCommandDelay]) - Tangent(dynamics[kInputTimeOffset]) +
               (plain[kCommandDelay] - plain[kInputTimeOffset])) {}

  /// Calls sink(stop, DriveSample) at every stop. @param shift_moves the shift of the input is
  /// differentiated. Errors: the motion is not finite or absurd, too stiff, or reverses without end.
  template <class Sink>
  Status Run(bool shift_moves, Sink&& sink) {
    shift_moves_ = shift_moves;
    q_ = dynamics_[kInitialPosition];
    v_ = dynamics_[kInitialSpeed];
    play_ = q_;
    const bool sampled = command_.sampled();
    const double shift = Value(shift_);
    held_.piece = PieceAt(0);
    int tick = 0;
    for (std::size_t stop = 0; stop < run_.stops.size();) {
      double target = run_.stops[stop];
      enum { kPrediction, kKink, kTick } what = kPrediction;
      const int next = held_.piece + 1;
      if (!sampled && next < static_cast<int>(run_.input.size()) && InputTime(next) + shift < target) {
        what = kKink;
        target = InputTime(next) + shift;
      }
      // A tick comes before a prediction at the same time; products and decimals may differ by rounding.
      const double period = run_.gains.control_period;
      if (sampled && tick * period <= target + kSameTick * period) {
        what = kTick;
        target = std::min(tick * period, target);
      }
      const bool moves = what == kKink && shift_moves_;
      T end(target);
      if (moves) end += Tangent(shift_);
      SINEW_TRY(Advance(end, moves));
      if (what == kKink) held_.piece = next;
      if (what == kTick) Tick(tick++);
      if (what == kPrediction) sink(stop++, Sample());
    }
    return {};
  }

 private:
  static constexpr bool kDifferentiates = !std::is_same_v<T, double>;
  static constexpr double kSameTick = 1e-9;   // of a control period
  static constexpr double kMostSteps = 1000;  // between two stops
  static constexpr int kMostEvents = 50;      // reversals and break-aways within one step

  /// What an evaluation needs besides the state.
  template <class S>
  struct Held {
    int piece = -1;  // of the input: after sample `piece`
    S command{0};    // output of a sampled controller
    S signal{0};     // its reference
  };
  template <class S>
  struct Motor {
    S command;  // torque or voltage at the motor
    S signal;   // recorded command, corrected
  };
  template <class S>
  struct Reached {
    S q;
    S v;
    double acceleration;  // at the step's begin
  };

  [[nodiscard]] double InputTime(int i) const { return run_.input_time[static_cast<std::size_t>(i)]; }

  /// The last sample of the input at or before t.
  [[nodiscard]] int PieceAt(double t) const {
    const double shift = Value(shift_);
    const auto after = std::partition_point(run_.input_time.begin(), run_.input_time.end(),
                                            [&](double sample) { return sample + shift <= t; });
    return static_cast<int>(after - run_.input_time.begin()) - 1;
  }

  template <class S, class Time>
  [[nodiscard]] S InputAt(const DriveDynamics<S>& dynamics, int piece, const Time& t) const {
    const auto at = static_cast<std::size_t>(std::max(piece, 0));
    const double slope = piece < 0 ? 0 : run_.slope[at];
    S u(run_.input[at]);
    if (slope != 0) {
      S line = S(slope * (t - (run_.input_time[at] + Value(shift_))));
      if (shift_moves_) {
        line -= slope * (Tangent(dynamics[kCommandDelay]) - Tangent(dynamics[kInputTimeOffset]));
      }
      if (dynamics.uses()[kHoldFraction]) line -= dynamics[kHoldFraction] * line;
      u += line;
    }
    if (!dynamics.uses().input_sensor) return u;
    u += dynamics[kInputLowPass] * slope;
    u -= dynamics[kInputOffset];
    u -= dynamics[kInputDrift] * (t - run_.middle);
    return u / dynamics[kInputGain];
  }

  template <class Time>
  [[nodiscard]] Time SupplyAt(int piece, const Time& t) const {
    const auto& time = run_.supply_time;
    if (time.empty()) return Time(run_.supply.front());
    if (Value(t) <= time.front()) return Time(run_.supply.front());
    if (Value(t) >= time.back()) return Time(run_.supply.back());
    auto i = static_cast<std::size_t>(std::max(piece, 0));  // right if both were recorded together
    if (i + 1 >= time.size() || !(time[i] <= Value(t) && Value(t) < time[i + 1])) {
      i = static_cast<std::size_t>(std::upper_bound(time.begin(), time.end(), Value(t)) - time.begin()) - 1;
    }
    const double slope = (run_.supply[i + 1] - run_.supply[i]) / (time[i + 1] - time[i]);
    return run_.supply[i] + slope * (t - time[i]);
  }

  template <class S, class Time>
  [[nodiscard]] Motor<S> MotorAt(const DriveDynamics<S>& dynamics, const Held<S>& held, const Time& t,
                                 const S& q, const S& v) const {
    if (command_.sampled()) return {dynamics.Weakened(held.command, t), held.signal};
    const S input = InputAt(dynamics, held.piece, t);
    switch (command_.input) {
      case DriveInput::kTorque:
      case DriveInput::kVoltage:
        return {dynamics.Weakened(input, t), input};
      case DriveInput::kDuty:
        return {dynamics.Weakened(input, t) * SupplyAt(held.piece, t), input};
      case DriveInput::kReference:
        break;
    }
    // The servo is continuous; feedback that is late by a little is q - delay v, to first order.
    S error = input - q;
    if (dynamics.uses()[kSensingDelay]) error += dynamics[kSensingDelay] * v;
    S duty = (run_.gains.servo_error_gain * run_.gains.kp) * error;
    if (Value(duty) > 1) duty = S(1);
    if (Value(duty) < -1) duty = S(-1);
    return {dynamics.Weakened(duty, t) * SupplyAt(held.piece, t), input};
  }

  template <class S, class Time>
  [[nodiscard]] typename DriveDynamics<S>::Loads LoadsAt(const DriveDynamics<S>& dynamics,
                                                         const Held<S>& held, const Time& t, const S& q,
                                                         const S& v) const {
    const Motor<S> motor = MotorAt(dynamics, held, t, q, v);
    return dynamics.LoadsAt(motor.command, motor.signal, t, q, v);
  }

  template <class S, class Time>
  [[nodiscard]] Reached<S> Step(const DriveDynamics<S>& dynamics, const Held<S>& held, double direction,
                                const Time& t, const Time& h, const S& q, const S& v) const {
    const auto acceleration = [&](const Time& at, const S& x, const S& dx) {
      return dynamics.Acceleration(direction, dx, LoadsAt(dynamics, held, at, x, dx));
    };
    const Time half = 0.5 * h;
    const Time middle = t + half;
    const S k1 = acceleration(t, q, v);
    const S v2 = v + half * k1;
    const S k2 = acceleration(middle, q + half * v, v2);
    const S v3 = v + half * k2;
    const S k3 = acceleration(middle, q + half * v2, v3);
    const S v4 = v + h * k3;
    const S k4 = acceleration(t + h, q + h * v3, v4);
    const Time sixth = h * (1.0 / 6);
    return {q + sixth * (v + 2.0 * (v2 + v3) + v4), v + sixth * (k1 + 2.0 * (k2 + k3) + k4), Value(k1)};
  }

  [[nodiscard]] Held<double> PlainHeld() const {
    return {held_.piece, Value(held_.command), Value(held_.signal)};
  }
  [[nodiscard]] double PlainSpeedAfter(double h) const {
    return Step(plain_, PlainHeld(), direction_, Value(time_), h, Value(q_), Value(v_)).v;
  }

  Status Advance(const T& end, bool end_moves) {
    const double span = Value(end) - Value(time_);
    const double wanted = std::ceil(
        span * (rate_ + drag_rate_ * std::max(std::abs(Value(v_)) - plain_.joint().largest_speed, 0.0)) *
        (1 - 1e-9));
    if (!(wanted <= kMostSteps)) {
      return Fail("trial '{}': too stiff to integrate at t = {:.4g} s", run_.trial,
                  run_.begin + Value(time_));
    }
    const int steps = std::max(static_cast<int>(wanted), 1);
    for (int i = steps; i > 1; --i) {
      if (time_moves_ || end_moves) {
        SINEW_TRY(Slide(time_ + (end - time_) * (1.0 / i), true));
      } else {
        SINEW_TRY(Slide(T(Value(time_) + (Value(end) - Value(time_)) * (1.0 / i)), false));
      }
    }
    return Slide(end, end_moves);
  }

  /// One step, with whatever happens in it.
  Status Slide(const T& end, bool end_moves) {
    for (int event = 0; event <= kMostEvents; ++event) {
      const double h = Value(end) - Value(time_);
      if (dynamics_.frictional() && Value(v_) == 0) Decide();
      if (stuck_) {
        if (Stick(end, end_moves)) return {};
        continue;
      }
      if (h <= 0) {
        Leap(end, end_moves);
        return {};
      }
      if (Value(v_) != 0) direction_ = Value(v_) > 0 ? 1 : -1;
      if (Value(v_) == 0 && !dynamics_.frictional()) {
        direction_ = 0;
        if (dynamics_.uses().dry_friction) direction_ = PlainSpeedAfter(h) >= 0 ? 1 : -1;
      }
      const bool moves = time_moves_ || end_moves;
      const Reached<T> next = moves ? Step(dynamics_, held_, direction_, time_, end - time_, q_, v_)
                                    : Step(dynamics_, held_, direction_, Value(time_), h, q_, v_);
      double from = 0;
      const double to = Crossing(h, next, from);
      if (to < 0) {  // the applied torque does not really move it
        v_ = T(0);
        SetTime(end, end_moves);
        return {};
      }
      if (to == 0) {
        q_ = next.q;
        v_ = next.v;
        SetTime(end, end_moves);
        return Check();
      }
      Stop(Root(from, to, [&](double s) { return direction_ * PlainSpeedAfter(s); }));
    }
    return Fail("trial '{}': more than {} reversals within one step at t = {:.6g} s", run_.trial, kMostEvents,
                run_.begin + Value(time_));
  }

  /// Whether the speed passes zero within a step of h: 0 if not, else a length after which it has, and
  /// `from`, one after which it has not; -1 if it does not even leave zero.
  double Crossing(double h, const Reached<T>& next, double& from) const {
    const double v0 = direction_ * Value(v_);
    const double v1 = direction_ * Value(next.v);
    if (v0 == 0) {
      if (!dynamics_.frictional() || v1 >= 0) return 0;
      for (double s = 0.5 * h; s > 1e-12 * h; s *= 0.5) {
        if (direction_ * PlainSpeedAfter(s) <= 0) continue;
        from = s;
        return 2 * s;
      }
      return -1;
    }
    if (v1 < 0) return h;
    // A dip below zero and back: the parabola through both speeds and the first acceleration tells.
    const double a0 = direction_ * next.acceleration;
    const double bend = (v1 - v0 - a0 * h) / (h * h);
    if (!(a0 < 0 && bend > 0)) return 0;
    const double lowest = -a0 / (2 * bend);
    if (!(lowest < h) || v0 + 0.5 * a0 * lowest > 0.1 * v0) return 0;
    return direction_ * PlainSpeedAfter(lowest) < 0 ? lowest : 0;
  }

  /// Where f turns from above 0 at `from` to below at `to`: regula falsi, Illinois variant, to rounding.
  template <class F>
  static double Root(double from, double to, F&& f) {
    constexpr int kMostIterations = 100;
    constexpr double kRounding = 1e-15;
    double low = f(from);
    double high = f(to);
    const double enough = kRounding * std::max(std::abs(low), std::abs(high));
    double side = 0;
    for (int i = 0; i < kMostIterations && to - from > kRounding * to; ++i) {
      double s = from + (to - from) * (low / (low - high));
      if (!(s > from && s < to)) s = 0.5 * (from + to);
      if (!(s > from && s < to)) break;
      const double value = f(s);
      if (value > 0) {
        from = s;
        low = value;
        if (side > 0) high *= 0.5;
        side = 1;
      } else {
        to = s;
        high = value;
        if (side < 0) low *= 0.5;
        side = -1;
      }
      if (std::abs(value) <= enough) return s;
    }
    return to;
  }

  /// Goes to the instant `length` from now, where the speed is zero.
  void Stop(double length) {
    if (!dynamics_.frictional()) {  // nothing jumps there: it does not matter when it is
      const Reached<T> next = time_moves_ ? Step(dynamics_, held_, direction_, time_, T(length), q_, v_)
                                          : Step(dynamics_, held_, direction_, Value(time_), length, q_, v_);
      q_ = next.q;
      v_ = Tangent(next.v);
      time_ += length;
      return;
    }
    if constexpr (kDifferentiates) {
      const Reached<T> there = time_moves_ ? Step(dynamics_, held_, direction_, time_, T(length), q_, v_)
                                           : Step(dynamics_, held_, direction_, Value(time_), length, q_, v_);
      using Along = Dual<1>;
      const Held<Along> held{held_.piece, Value(held_.command), Value(held_.signal)};
      const double slope = Step(AlongTime(), held, direction_, Along(Value(time_)),
                                Along::Variable(length, 0), Along(Value(q_)), Along(Value(v_)))
                               .v.d[0];
      T exact(length);
      if (slope != 0) exact -= Tangent(there.v) * (1 / slope);
      q_ = Step(dynamics_, held_, direction_, time_, exact, q_, v_).q;
      time_ += exact;
      time_moves_ = true;
    } else {
      q_ = Step(dynamics_, held_, direction_, time_, length, q_, v_).q;
      time_ += length;
    }
    v_ = T(0);
  }

  /// At rest under friction: stick, or slip, and where to.
  void Decide() {
    const auto loads = LoadsAt(plain_, PlainHeld(), Value(time_), Value(q_), 0.0);
    stuck_ = false;
    if (loads.applied > plain_.Friction(1, 0, loads)) {
      direction_ = 1;
    } else if (loads.applied < -plain_.Friction(-1, 0, loads)) {
      direction_ = -1;
    } else {
      stuck_ = true;
      v_ = T(0);
    }
  }

  /// Applied torque minus what holds it, at rest: above 0 it moves.
  template <class S, class Time>
  [[nodiscard]] S Excess(const DriveDynamics<S>& dynamics, const Held<S>& held, const Time& t,
                         const S& q) const {
    const S rest(0);
    const auto loads = LoadsAt(dynamics, held, t, q, rest);
    const double direction = Value(loads.applied) > 0 ? 1 : -1;
    return direction * loads.applied - dynamics.Friction(direction, rest, loads);
  }

  /// Rests until the end (true), or until it breaks away.
  bool Stick(const T& end, bool end_moves) {
    const Held<double> held = PlainHeld();
    const auto holds = [&](double t) { return -Excess(plain_, held, t, Value(q_)); };
    if (Value(end) <= Value(time_) || holds(Value(end)) >= 0) {
      SetTime(end, end_moves);
      return true;
    }
    const double begin = Value(time_);
    double away = begin + Root(0, Value(end) - begin, [&](double s) { return holds(begin + s); });
    // Root may stop a rounding error before the break-away.
    for (double more = 1e-16 * (1 + std::abs(away)); holds(away) >= 0; more *= 2) {
      away = std::min(away + more, Value(end));
    }
    T instant(away);
    if constexpr (kDifferentiates) {
      using Along = Dual<1>;
      const Held<Along> along{held.piece, held.command, held.signal};
      const double slope = Excess(AlongTime(), along, Along::Variable(away, 0), Along(Value(q_))).d[0];
      if (slope != 0) instant -= Tangent(Excess(dynamics_, held_, away, q_)) * (1 / slope);
    }
    SetTime(instant, true);
    stuck_ = false;
    return false;
  }

  /// To a time that has the same value but other derivatives.
  void Leap(const T& end, bool end_moves) {
    if (time_moves_ || end_moves) {
      const auto loads = LoadsAt(dynamics_, held_, Value(time_), q_, v_);
      const T length = Tangent(end) - Tangent(time_);
      const double acceleration = Value(dynamics_.Acceleration(direction_, v_, loads));
      q_ += Value(v_) * length;
      v_ += acceleration * length;
    }
    SetTime(end, end_moves);
  }

  void SetTime(const T& t, bool moves) {
    time_ = t;
    time_moves_ = moves && kDifferentiates;
  }

  [[nodiscard]] Status Check() const {
    if (std::abs(Value(q_)) <= command_.most_position && std::abs(Value(v_)) <= command_.most_speed)
      return {};
    return Fail("trial '{}': the motion runs away at t = {:.4g} s (position {:.3g}, speed {:.3g})",
                run_.trial, run_.begin + Value(time_), Value(q_), Value(v_));
  }

  /// A sampled controller sees the joint and sets its output until the next tick.
  void Tick(int tick) {
    const DriveControllerGains& gains = run_.gains;
    const double now = Value(time_);
    const T reference = InputAt(dynamics_, PieceAt(now), now);
    const T seen = Feedback(tick, gains.control_period);
    const T error = reference - seen;
    const T grown = integral_ + gains.control_period * error;
    T output = gains.kp * error + gains.ki * grown;
    if (tick > 0) output += (gains.kd / gains.control_period) * (error - last_error_);
    const double limit = gains.output_limit;
    const bool clipped = limit > 0 && std::abs(Value(output)) > limit;
    if (clipped) output = T(Value(output) > 0 ? limit : -limit);
    // Anti-windup by conditional integration: the integral never grows further into the limit.
    if (!clipped || Value(output) * Value(error) * gains.ki <= 0) integral_ = grown;
    last_error_ = error;
    held_.command = output;
    held_.signal = reference;
  }

  /// Position or speed of the joint at the tick, late by sensing_delay: straight between ticks.
  [[nodiscard]] T Feedback(int tick, double period) {
    const T& now = command_.controller == DriveControllerKind::kPidSpeed ? v_ : q_;
    if (!dynamics_.uses()[kSensingDelay]) return now;
    const auto slots = static_cast<int>(history_.size());
    history_[static_cast<std::size_t>(tick % slots)] = now;
    const T age = dynamics_[kSensingDelay] * (1 / period);
    const int whole = std::min(static_cast<int>(Value(age)), slots - 2);
    const auto at = [&](int ago) -> const T& {
      return history_[static_cast<std::size_t>(std::max(tick - ago, 0) % slots)];
    };
    const T part = age - static_cast<double>(whole);
    return at(whole) + part * (at(whole + 1) - at(whole));
  }

  [[nodiscard]] DriveSample<T> Sample() {
    if (dynamics_.uses()[kBacklash]) {
      const T half = 0.5 * dynamics_[kBacklash];
      if (Value(play_) < Value(q_) - Value(half)) play_ = q_ - half;
      if (Value(play_) > Value(q_) + Value(half)) play_ = q_ + half;
    } else {
      play_ = q_;
    }
    // At a sample of a held input, the new value counts.
    Held<T> held = held_;
    const double now = Value(time_);
    if (!command_.sampled() && held.piece + 1 < static_cast<int>(run_.input.size()) &&
        InputTime(held.piece + 1) + Value(shift_) <= now) {
      ++held.piece;
    }
    const Motor<T> motor = MotorAt(dynamics_, held, now, q_, v_);
    DriveSample<T> sample{play_, v_, dynamics_.DriveTorque(motor.command, v_), T(0)};
    if (dynamics_.joint().electric) sample.current = dynamics_.Current(motor.command, v_);
    if (dynamics_.uses()[kCompliance]) sample.position += dynamics_[kCompliance] * sample.torque;
    return sample;
  }

  /// The dynamics with time as the only variable; made when first needed.
  const DriveDynamics<Dual<1>>& AlongTime() {
    if (!along_ready_) {
      typename DriveDynamics<Dual<1>>::Numbers numbers;
      for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = plain_.numbers()[i];
      along_ = DriveDynamics<Dual<1>>(plain_.joint(), numbers, plain_.uses(), plain_.frictional());
      along_ready_ = true;
    }
    return along_;
  }

  const DriveCommand& command_;
  const DriveRun& run_;
  const DriveDynamics<T>& dynamics_;
  const DriveDynamics<double>& plain_;
  double rate_;
  double drag_rate_;  // [1/s per speed] its growth beyond the measured speeds
  DriveHistory<T>& history_;
  T shift_;                   // of the input [s]
  bool shift_moves_ = false;  // it is differentiated

  T time_{0};
  bool time_moves_ = false;  // time_ has derivatives
  T q_{0};
  T v_{0};
  T play_{0};  // position behind the play
  bool stuck_ = false;
  double direction_ = 0;  // of slip
  Held<T> held_;
  T integral_{0};
  T last_error_{0};
  DriveDynamics<Dual<1>> along_{plain_.joint(), {}, {}, false};
  bool along_ready_ = false;
};

/// Ticks that the longest sensing delay reaches back.
[[nodiscard]] inline std::size_t DriveHistorySize(double longest_delay, double control_period) {
  return static_cast<std::size_t>(longest_delay / control_period) + 3;
}

}  // namespace sinew
