// A moment about the ankle that no law of the model describes: curves of several signals, which are added.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "base/linear_curve.h"

namespace sinew {

/// What an unknown moment may depend on.
enum class MomentSignal {
  kAngle,       ///< of the ankle [rad]
  kVelocity,    ///< of the ankle [rad/s]
  kActivation,  ///< mean of the muscles' [1]
  kTime,        ///< since the trial began [s]
  kCount
};
inline constexpr std::size_t kMomentSignals = static_cast<std::size_t>(MomentSignal::kCount);
inline constexpr std::size_t kMomentKnots = 8;
using MomentKnots = std::array<std::vector<double>, kMomentSignals>;  ///< [signals][kMomentKnots, increasing]

/// T is double or Dual.
template <class T>
struct UnknownMoment {
  using Weights = std::array<T, kMomentKnots>;
  const MomentKnots* knots = nullptr;             ///< not owned
  std::array<bool, kMomentSignals> acts{};        ///< a weight, or a derivative for it, is not 0
  std::array<Weights, kMomentSignals> weights{};  ///< [N m]

  [[nodiscard]] bool Acts() const {
    return std::any_of(acts.begin(), acts.end(), [](bool one) { return one; });
  }

  /// [N m] @param angle T or double
  template <class A>
  [[nodiscard]] T Moment(const A& angle, const T& velocity, const T& activation, double time) const {
    T sum(0.0);
    const auto add = [&](MomentSignal signal, const auto& x) {
      const auto i = static_cast<std::size_t>(signal);
      if (acts[i]) sum += LinearCurveAt((*knots)[i], weights[i].data(), x);
    };
    add(MomentSignal::kAngle, angle);
    add(MomentSignal::kVelocity, velocity);
    add(MomentSignal::kActivation, activation);
    add(MomentSignal::kTime, time);
    return sum;
  }
};

}  // namespace sinew
