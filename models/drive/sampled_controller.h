// A sampled controller: sees the joint at its ticks, and holds its output between them.
#pragma once

#include <algorithm>
#include <vector>

#include "models/drive/actuation.h"
#include "models/drive/control_law.h"

namespace sinew {

/// Feedback that a sampled controller has seen, a ring over its ticks.
template <class T>
using DriveHistory = std::vector<T>;

/// Ticks that the longest delay of the feedback reaches back.
[[nodiscard]] inline std::size_t DriveHistorySize(double longest_delay, double control_period) {
  return static_cast<std::size_t>(longest_delay / control_period) + 3;
}

template <class T>
class DriveSampledController {
 public:
  /// @param history scratch of the size DriveHistorySize. All must outlive this.
  DriveSampledController(const DriveCommand& command, const DriveControllerGains& gains,
                         const DriveDynamics<T>& dynamics, DriveHistory<T>& history)
      : command_(command),
        gains_(gains),
        dynamics_(dynamics),
        history_(history),
        law_(command.controller, gains, dynamics[kInitialIntegral]) {}

  /// A share of the control period: times that differ by less are the same. Recorded times jitter.
  static constexpr double kSameTime = 1e-4;

  /// Sees the joint at q, v and sets its output until the next tick.
  /// @param now time of the tick [s]. @param held gets the output and the reference.
  void Tick(int tick, double now, const T& q, const T& v, const DriveActuation& actuation,
            DriveHeld<T>& held) {
    const double tolerance = kSameTime * gains_.control_period;
    const T reference = actuation.InputAt(dynamics_, actuation.PieceOfTick(now, tolerance), now);
    const T seen = Feedback(tick, command_.controller == DriveControllerKind::kPidSpeed ? v : q);
    held.command =
        law_.Output({reference, seen, v, actuation.DisturbanceAt(dynamics_, now, tolerance), held.on});
    held.signal = reference;
  }

 private:
  /// Position or speed of the joint at the tick, late by sensing_delay and actuation_delay: straight between
  /// ticks.
  [[nodiscard]] T Feedback(int tick, const T& now) {
    if (!dynamics_.uses().feedback_is_late()) return now;
    const auto slots = static_cast<int>(history_.size());
    history_[static_cast<std::size_t>(tick % slots)] = now;
    const T age = dynamics_.AgeOfFeedback() * (1 / gains_.control_period);
    const int whole = std::min(static_cast<int>(Value(age)), slots - 2);
    const auto at = [&](int ago) -> const T& {
      return history_[static_cast<std::size_t>(std::max(tick - ago, 0) % slots)];
    };
    const T part = age - static_cast<double>(whole);
    return at(whole) + part * (at(whole + 1) - at(whole));
  }

  const DriveCommand& command_;
  const DriveControllerGains& gains_;
  const DriveDynamics<T>& dynamics_;
  DriveHistory<T>& history_;
  DriveControlLaw<T> law_;
};

}  // namespace sinew
