// What acts on the joint at a time: the recorded input through its sensor, the command that reaches the
// motor, and the torques that follow from it. On double or on dual numbers, in state and in time.
#pragma once

#include <algorithm>
#include <vector>

#include "models/drive/dynamics.h"
#include "models/drive/run.h"

namespace sinew {

/// What an evaluation needs besides the state.
template <class S>
struct DriveHeld {
  int piece = -1;  // of the input: after sample `piece`
  S command{0};    // output of a sampled controller
  S signal{0};     // its reference
  bool on = true;  // the motor; off, it is an open circuit
};

class DriveActuation {
 public:
  /// @param shift of the input [s]. @param shift_moves it is differentiated. @param command and @param run
  /// must outlive this.
  DriveActuation(const DriveCommand& command, const DriveRun& run, double shift, bool shift_moves)
      : command_(command), run_(run), shift_(shift), shift_moves_(shift_moves) {}

  [[nodiscard]] bool shift_moves() const { return shift_moves_; }
  /// When sample i of the input acts.
  [[nodiscard]] double InputTime(int i) const {
    return run_.input_time[static_cast<std::size_t>(i)] + shift_;
  }

  /// The last sample of the input at or before t.
  [[nodiscard]] int PieceAt(double t) const {
    const auto after = std::partition_point(run_.input_time.begin(), run_.input_time.end(),
                                            [&](double sample) { return sample + shift_ <= t; });
    return static_cast<int>(after - run_.input_time.begin()) - 1;
  }

  /// PieceAt for a tick of a controller. A held input jumps at its samples: of a sample that is later by less
  /// than `tolerance` the tick has the value already.
  [[nodiscard]] int PieceOfTick(double t, double tolerance) const {
    return PieceAt(run_.held ? t + tolerance : t);
  }

  template <class S, class Time>
  [[nodiscard]] S InputAt(const DriveDynamics<S>& dynamics, int piece, const Time& t) const {
    const auto at = static_cast<std::size_t>(std::max(piece, 0));
    const double slope = piece < 0 ? 0 : run_.slope[at];
    S u(run_.input[at]);
    if (slope != 0) {
      const Time rise = slope * (t - (run_.input_time[at] + shift_));
      if (shift_moves_ || dynamics.uses()[kHoldFraction]) {
        S line(rise);
        if (shift_moves_) line -= slope * Tangent(dynamics.ShiftOfInput());
        if (dynamics.uses()[kHoldFraction]) line -= dynamics[kHoldFraction] * line;
        u += line;
      } else {
        u += rise;
      }
    }
    if (!dynamics.uses().input_sensor) return u;
    u += dynamics[kInputLowPass] * slope;
    u -= dynamics[kInputOffset];
    u -= dynamics[kInputDrift] * (t - run_.middle);
    return u / dynamics[kInputGain];
  }

  /// @param piece of the input: where to look first
  template <class Time>
  [[nodiscard]] Time SignalAt(DriveSignal signal, int piece, const Time& t) const {
    const DriveSeries& series = run_.signals[signal];
    const auto& time = series.time;
    if (time.empty()) return Time(series.values.front());
    if (Value(t) <= time.front()) return Time(series.values.front());
    if (Value(t) >= time.back()) return Time(series.values.back());
    // Right if both were recorded together, a few samples off with a delay between them.
    auto i = static_cast<std::size_t>(std::clamp<int>(piece, 0, static_cast<int>(time.size()) - 2));
    constexpr int kNear = 8;
    for (int near = 0; near < kNear && time[i] > Value(t); ++near) --i;
    for (int near = 0; near < kNear && time[i + 1] <= Value(t); ++near) ++i;
    if (!(time[i] <= Value(t) && Value(t) < time[i + 1])) {
      i = static_cast<std::size_t>(std::upper_bound(time.begin(), time.end(), Value(t)) - time.begin()) - 1;
    }
    return series.values[i] + series.slope[i] * (t - time[i]);
  }

  /// What is added to the output of a controller that acts at a tick; like the input, held or straight
  /// between samples. Output that acts late was computed earlier.
  template <class S>
  [[nodiscard]] S DisturbanceAt(const DriveDynamics<S>& dynamics, double tick, double tolerance) const {
    const auto& [time, values, slopes] = run_.disturbance;
    if (values.empty()) return S(0);
    const bool late = dynamics.uses()[kActuationDelay];
    const double t = late ? tick - Value(dynamics[kActuationDelay]) : tick;
    const auto after = std::upper_bound(time.begin(), time.end(), run_.held ? t + tolerance : t);
    if (after == time.begin()) return S(values.front());
    const auto i = static_cast<std::size_t>(after - time.begin()) - 1;
    if (run_.held || after == time.end()) return S(values[i]);
    S value(values[i] + slopes[i] * (t - time[i]));
    if (late) value -= slopes[i] * Tangent(dynamics[kActuationDelay]);
    return value;
  }

  /// Torque or voltage at the motor.
  template <class S, class Time>
  [[nodiscard]] S CommandAt(const DriveDynamics<S>& dynamics, const DriveHeld<S>& held, const Time& t,
                            const S& q, const S& v) const {
    if (command_.sampled()) {
      S command = held.command;
      dynamics.Weaken(command, t, run_.session);
      return command;
    }
    S command = InputAt(dynamics, held.piece, t);
    if (command_.input == DriveInput::kReference) {
      // The servo is continuous; feedback that is late by a little is q - delay v, to first order.
      command -= q;
      if (dynamics.uses().feedback_is_late()) AddProduct(command, dynamics.AgeOfFeedback(), v);
      command = (run_.gains.servo_error_gain * run_.gains.kp) * command;
      if (Value(command) > 1) command = S(1);
      if (Value(command) < -1) command = S(-1);
    }
    dynamics.Weaken(command, t, run_.session);
    if (command_.input == DriveInput::kReference || command_.input == DriveInput::kDuty)
      command = command * SignalAt(kSupplyVoltage, held.piece, t);
    return command;
  }

  /// The recorded command, corrected.
  template <class S, class Time>
  [[nodiscard]] S RecordedCommandAt(const DriveDynamics<S>& dynamics, const DriveHeld<S>& held,
                                    const Time& t) const {
    return command_.sampled() ? held.signal : InputAt(dynamics, held.piece, t);
  }

  template <class S, class Time>
  [[nodiscard]] typename DriveDynamics<S>::Loads LoadsAt(const DriveDynamics<S>& dynamics,
                                                         const DriveHeld<S>& held, const Time& t, const S& q,
                                                         const S& v) const {
    const auto signal = [&] { return RecordedCommandAt(dynamics, held, t); };
    const auto recorded = [&](DriveSignal of) { return SignalAt(of, held.piece, t); };
    const S drive = held.on ? dynamics.DriveTorque(CommandAt(dynamics, held, t, q, v), v, t) : S(0);
    return dynamics.LoadsAt(drive, signal, recorded, t, q, v);
  }

  /// Applied torque minus what holds it, at rest: above 0 it moves.
  template <class S, class Time>
  [[nodiscard]] S Excess(const DriveDynamics<S>& dynamics, const DriveHeld<S>& held, const Time& t,
                         const S& q) const {
    const S rest(0);
    const auto loads = LoadsAt(dynamics, held, t, q, rest);
    const double direction = Value(loads.applied) > 0 ? 1 : -1;
    return direction * loads.applied - dynamics.Friction(direction, rest, loads);
  }

 private:
  const DriveCommand& command_;
  const DriveRun& run_;
  double shift_;
  bool shift_moves_;
};

}  // namespace sinew
