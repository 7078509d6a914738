// Moment of an ankle whose muscles are silent, beside their own passive forces: ligaments, skin, other
// muscles.
//
//   M = -K (exp(b x) - 1) / b - L x - D q',  x = q - rest angle
//
// The exponential towards dorsiflexion: Riener, Edrich (1999), J. Biomech. 32:539-544.
#pragma once

#include "base/dual_math.h"

namespace sinew {

/// T is double or Dual.
template <class T>
struct PassiveAnkle {
  T stiffness{10.0};        ///< K [N m/rad, >= 0]
  T exponent{4.0};          ///< b [1/rad, > 0]
  T rest_angle{-0.3};       ///< [rad]
  T linear_stiffness{5.0};  ///< L [N m/rad, >= 0]
  T damping{0.3};           ///< D [N m s/rad, >= 0]
  T hysteresis{0.0};        ///< moment against the velocity, whatever its size [N m, >= 0]

  static constexpr double kHysteresisVelocity = 0.02;  ///< below it the moment is smaller [rad/s]

  template <class A, class B>
  [[nodiscard]] T Moment(const A& angle, const B& velocity) const {
    const T x = angle - rest_angle;
    return -(stiffness / exponent * (exp(exponent * x) - 1.0) + linear_stiffness * x + damping * velocity +
             hysteresis * tanh(velocity * (1 / kHysteresisVelocity)));
  }

  /// [J]
  template <class A>
  [[nodiscard]] T Stored(const A& angle) const {
    const T x = angle - rest_angle;
    return stiffness / exponent * ((exp(exponent * x) - 1.0) / exponent - x) + 0.5 * linear_stiffness * x * x;
  }

  /// Power [W].
  template <class B>
  [[nodiscard]] T Dissipated(const B& velocity) const {
    return (damping * velocity + hysteresis * tanh(velocity * (1 / kHysteresisVelocity))) * velocity;
  }
};

}  // namespace sinew
