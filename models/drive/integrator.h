// Integrates the joint through one trial, with exact sensitivities if T is Dual<N>.
//
// Classical Runge-Kutta of order 4. Steps end where something is discontinuous: at samples of the input (as
// shifted by command_delay and time_offset), at ticks of a sampled controller, where the motor is switched
// off or on, and at reversals. Where such an instant depends on parameters, time itself is a dual number,
// which is what saltation matrices are made of.
//
// Dry friction is a set-valued law: the joint slips in one direction until its speed is zero, which is
// located by root finding; there it sticks if the break-away friction holds the applied torque, else it slips
// into the direction of that torque; it breaks away at the instant when the torque exceeds the friction,
// located too. Without friction the same zeros are located (so that no value depends on whether friction is
// differentiated) and nothing happens there.
//
// Kinks that are no jumps (limits of torque, speed and servo duty; linear basis functions of discrepancy
// terms in q and v) are not located: the order drops there to 2 locally, the derivatives remain those of the
// discrete map.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>

#include "base/constants.h"
#include "base/error.h"
#include "models/drive/actuation.h"
#include "models/drive/sampled_controller.h"
#include "models/drive/step.h"

namespace sinew {

/// What is predicted at one time.
template <class T>
struct DriveSample {
  T position;  ///< as seen: behind play and wind-up
  T speed;
  T torque;
  T current;
};

template <class T>
class DriveIntegrator {
 public:
  /// @param history scratch of the size DriveHistorySize. @param rate [1/s] of the fastest thing that can
  /// happen at speeds as they were measured: steps are at most its inverse, and shorter at higher speeds.
  /// @param shift_moves the shift of the input is differentiated. @param wants_torque samples hold torque and
  /// current, too; else these are 0.
  DriveIntegrator(const DriveCommand& command, const DriveRun& run, const DriveDynamics<T>& dynamics,
                  const DriveDynamics<double>& plain, double rate, bool shift_moves, bool wants_torque,
                  DriveHistory<T>& history)
      : command_(command),
        run_(run),
        dynamics_(dynamics),
        plain_(plain),
        rate_(std::max(rate, 1 / command.step)),
        drag_rate_(2 * plain[kDrag] * plain.inverse_mass()),
        wants_torque_(wants_torque),
        shift_(Tangent(dynamics.ShiftOfInput()) + plain.ShiftOfInput()),
        actuation_(command, run, Value(shift_), shift_moves),
        controller_(command, run.gains, dynamics, history) {}

  /// Calls sink(stop, DriveSample) at every stop from `first` up to, but not at, `end`, beginning at `first`
  /// with the initial state. @param reading measured there: where a reading behind play begins, as far as the
  /// play allows; nothing: in its middle. @pre first is 0 if the controller is sampled: it has a memory.
  /// Errors: the motion is not finite or absurd, too stiff, or reverses without end.
  template <class Sink>
  Status Run(std::size_t first, std::size_t end, std::optional<double> reading, Sink&& sink) {
    time_ = T(run_.stops[first]);
    q_ = dynamics_[kInitialPosition];
    v_ = dynamics_[kInitialSpeed];
    // Without play it is the position; its derivative for the width, at none, is that of the middle.
    play_ = reading && plain_[kBacklash] > 0 ? T(*reading) : q_;
    const bool sampled = command_.sampled();
    held_.piece = actuation_.PieceAt(run_.stops[first]);
    held_.on = run_.OnAt(run_.stops[first]);
    std::size_t next_switch = static_cast<std::size_t>(
        std::upper_bound(run_.switches.begin(), run_.switches.end(), run_.stops[first]) -
        run_.switches.begin());
    int tick = 0;
    for (std::size_t stop = first; stop < end;) {
      double target = run_.stops[stop];
      enum { kPrediction, kKink, kTick, kSwitch } what = kPrediction;
      const int next = held_.piece + 1;
      if (!sampled && next < static_cast<int>(run_.input.size()) && actuation_.InputTime(next) < target) {
        what = kKink;
        target = actuation_.InputTime(next);
      }
      // A tick comes before a prediction at the same time; recorded times jitter.
      const double period = run_.gains.control_period;
      if (sampled && tick * period <= target + DriveSampledController<T>::kSameTime * period) {
        what = kTick;
        target = std::min(tick * period, target);
      }
      // The motor is switched before anything else at that time.
      const double same = sampled ? DriveSampledController<T>::kSameTime * period : 0;
      if (next_switch < run_.switches.size() && run_.switches[next_switch] <= target + same) {
        what = kSwitch;
        target = std::min(run_.switches[next_switch], target);
      }
      const bool moves = what == kKink && actuation_.shift_moves();
      T instant(target);
      if (moves) instant += Tangent(shift_);
      SINEW_TRY(Advance(instant, moves));
      if ((what == kTick || what == kSwitch) && Value(time_) > changed_ + same) {
        before_ = held_;
        changed_ = Value(time_);
      }
      if (what == kKink) held_.piece = next;
      if (what == kSwitch) {
        ++next_switch;
        held_.on = !held_.on;
      }
      if (what == kTick) {
        // The first one begins with the given speed also where friction holds the joint: with its derivative.
        const T& v = tick == 0 && Value(time_) == run_.stops[first] ? dynamics_[kInitialSpeed] : v_;
        controller_.Tick(tick++, Value(time_), q_, v, actuation_, held_);
      }
      if (what == kPrediction) sink(stop++, Sample());
    }
    return {};
  }

  /// The state of the joint at the last stop of Run.
  [[nodiscard]] const T& position() const { return q_; }
  [[nodiscard]] const T& speed() const { return v_; }

 private:
  static constexpr bool kDifferentiates = !std::is_same_v<T, double>;
  static constexpr int kMaxEvents = 50;  // reversals and break-aways within one step

  [[nodiscard]] DriveHeld<double> PlainHeld() const {
    return {held_.piece, Value(held_.command), Value(held_.signal), held_.on};
  }
  [[nodiscard]] double PlainSpeedAfter(double h) const {
    return DriveStep(actuation_, plain_, PlainHeld(), direction_, Value(time_), h, Value(q_), Value(v_)).v;
  }

  Status Advance(const T& end, bool end_moves) {
    const double span = Value(end) - Value(time_);
    const double wanted = std::ceil(
        span * (rate_ + drag_rate_ * std::max(std::abs(Value(v_)) - plain_.joint().largest_speed, 0.0)) *
        (1 - 1e-9));
    if (!(wanted <= command_.most_steps)) {
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
    for (int event = 0; event <= kMaxEvents; ++event) {
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
      const DriveReached<T> next =
          moves ? DriveStep(actuation_, dynamics_, held_, direction_, time_, end - time_, q_, v_)
                : DriveStep(actuation_, dynamics_, held_, direction_, Value(time_), h, q_, v_);
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
      Stop(FallingRoot(from, to, [&](double s) { return direction_ * PlainSpeedAfter(s); }));
    }
    return Fail("trial '{}': more than {} reversals within one step at t = {:.6g} s", run_.trial, kMaxEvents,
                run_.begin + Value(time_));
  }

  /// Whether the speed passes zero within a step of h: 0 if not, else a length after which it has, and
  /// `from`, one after which it has not; -1 if it does not even leave zero.
  double Crossing(double h, const DriveReached<T>& next, double& from) const {
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

  /// Goes to the instant `length` from now, where the speed is zero.
  void Stop(double length) {
    if (!dynamics_.frictional()) {  // nothing jumps there: it does not matter when it is
      const DriveReached<T> next =
          time_moves_ ? DriveStep(actuation_, dynamics_, held_, direction_, time_, T(length), q_, v_)
                      : DriveStep(actuation_, dynamics_, held_, direction_, Value(time_), length, q_, v_);
      q_ = next.q;
      v_ = Tangent(next.v);
      time_ += length;
      return;
    }
    if constexpr (kDifferentiates) {
      const DriveReached<T> there =
          time_moves_ ? DriveStep(actuation_, dynamics_, held_, direction_, time_, T(length), q_, v_)
                      : DriveStep(actuation_, dynamics_, held_, direction_, Value(time_), length, q_, v_);
      using Along = Dual<1>;
      const DriveHeld<Along> held{held_.piece, Value(held_.command), Value(held_.signal), held_.on};
      const double slope = DriveStep(actuation_, AlongTime(), held, direction_, Along(Value(time_)),
                                     Along::Variable(length, 0), Along(Value(q_)), Along(Value(v_)))
                               .v.d[0];
      T exact(length);
      if (slope != 0) exact -= Tangent(there.v) * (1 / slope);
      q_ = DriveStep(actuation_, dynamics_, held_, direction_, time_, exact, q_, v_).q;
      time_ += exact;
      time_moves_ = true;
    } else {
      q_ = DriveStep(actuation_, dynamics_, held_, direction_, time_, length, q_, v_).q;
      time_ += length;
    }
    v_ = T(0);
  }

  /// At rest under friction: stick, or slip, and where to.
  void Decide() {
    const auto loads = actuation_.LoadsAt(plain_, PlainHeld(), Value(time_), Value(q_), 0.0);
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

  /// Rests until the end (true), or until it breaks away.
  bool Stick(const T& end, bool end_moves) {
    const DriveHeld<double> held = PlainHeld();
    const auto holds = [&](double t) { return -actuation_.Excess(plain_, held, t, Value(q_)); };
    if (Value(end) <= Value(time_) || holds(Value(end)) >= 0) {
      SetTime(end, end_moves);
      return true;
    }
    const double begin = Value(time_);
    double away = begin + FallingRoot(0, Value(end) - begin, [&](double s) { return holds(begin + s); });
    // The root may be a rounding error before the break-away.
    for (double more = 1e-16 * (1 + std::abs(away)); holds(away) >= 0; more *= 2) {
      away = std::min(away + more, Value(end));
    }
    T instant(away);
    if constexpr (kDifferentiates) {
      using Along = Dual<1>;
      const DriveHeld<Along> along{held.piece, held.command, held.signal, held.on};
      const double slope =
          actuation_.Excess(AlongTime(), along, Along::Variable(away, 0), Along(Value(q_))).d[0];
      if (slope != 0) instant -= Tangent(actuation_.Excess(dynamics_, held_, away, q_)) * (1 / slope);
    }
    SetTime(instant, true);
    stuck_ = false;
    return false;
  }

  /// To a time that has the same value but other derivatives.
  void Leap(const T& end, bool end_moves) {
    if (time_moves_ || end_moves) {
      const auto loads = actuation_.LoadsAt(dynamics_, held_, Value(time_), q_, v_);
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

  [[nodiscard]] DriveSample<T> Sample() {
    if (dynamics_.uses()[kBacklash]) {
      const T half = 0.5 * dynamics_[kBacklash];
      if (Value(play_) < Value(q_) - Value(half)) play_ = q_ - half;
      if (Value(play_) > Value(q_) + Value(half)) play_ = q_ + half;
    } else {
      play_ = q_;
    }
    const double now = Value(time_);
    DriveSample<T> sample{play_, v_, T(0), T(0)};
    // A reading at a tick is what the controller sees, before its next command acts.
    if (dynamics_.uses()[kCompliance]) {
      const double same =
          command_.sampled() ? DriveSampledController<T>::kSameTime * run_.gains.control_period : 0;
      const DriveHeld<T>& acting = now <= changed_ + same ? before_ : held_;
      if (acting.on) {
        const T command = actuation_.CommandAt(dynamics_, acting, now, q_, v_);
        sample.position += dynamics_[kCompliance] * dynamics_.DriveTorque(command, v_, now);
      }
    }
    if (!wants_torque_) return sample;
    // At a sample of a held input, the new value counts.
    DriveHeld<T> held = held_;
    if (!command_.sampled() && held.piece + 1 < static_cast<int>(run_.input.size()) &&
        actuation_.InputTime(held.piece + 1) <= now) {
      ++held.piece;
    }
    if (held.on) {
      const T command = actuation_.CommandAt(dynamics_, held, now, q_, v_);
      sample.torque = dynamics_.DriveTorque(command, v_, now);
      if (dynamics_.joint().electric) sample.current = dynamics_.Current(command, v_, now);
    }
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
  bool wants_torque_;
  T shift_;  // of the input [s]
  DriveActuation actuation_;
  DriveSampledController<T> controller_;

  T time_{0};
  bool time_moves_ = false;  // time_ has derivatives
  T q_{0};
  T v_{0};
  T play_{0};  // position behind the play
  bool stuck_ = false;
  double direction_ = 0;  // of slip
  DriveHeld<T> held_;
  DriveHeld<T> before_;          // the last change at a tick or switch
  double changed_ = -kInfinity;  // when that was
  DriveDynamics<Dual<1>> along_{plain_.joint(), {}, {}, false};
  bool along_ready_ = false;
};

}  // namespace sinew
