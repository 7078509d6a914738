// The dynamometer's moving part without a foot on it.
//
//   torque that its motor must hold against:  J p'' + B p' + C tanh(p' / w) + G cos(p + g - tilt) + S p
#pragma once

#include "base/dual_math.h"

namespace sinew {

/// T is double or Dual.
template <class T>
struct Attachment {
  T inertia{0.05};          ///< J [kg m2, >= 0]
  T gravity{2.0};           ///< G: weight times distance of its centre of mass [N m, >= 0]
  T gravity_angle{0.0};     ///< g: direction of its centre of mass at p = 0, from x [rad]
  T viscous_friction{0.1};  ///< B [N m s/rad, >= 0]
  T coulomb_friction{0.0};  ///< C [N m, >= 0]
  T one_way_friction{0.0};  ///< more of C with positive velocity alone [N m]
  T load_friction{0.0};     ///< friction per torque between plate and foot [1, >= 0]
  T stiffness{0.0};         ///< S: of cables and hoses that turn with it [N m/rad]

  static constexpr double kSlowest = 0.02;  ///< w: below it Coulomb friction is smaller [rad/s]

  /// @param load torque of foot and plate on each other [N m]
  [[nodiscard]] T Friction(double velocity, const T& load) const {
    const double direction = std::tanh(velocity / kSlowest);
    const T both_ways = coulomb_friction + load_friction * abs(load);
    return viscous_friction * velocity + direction * both_ways + std::max(direction, 0.0) * one_way_friction;
  }

  /// Moment of its weight about the machine's axis [N m].
  [[nodiscard]] T WeightMoment(double angle, double tilt) const {
    return -gravity * cos(gravity_angle + (angle - tilt));
  }

  /// Moment of cables and hoses about the machine's axis; what they pull at the angle 0 is a zero of the
  /// torque [N m].
  [[nodiscard]] T CableMoment(double angle) const { return -stiffness * angle; }
};

}  // namespace sinew
