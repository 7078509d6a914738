// What one run of a strapped foot shows and leaves: instants, and solutions from which derivatives follow
// (implicit function theorem).
#pragma once

#include <array>
#include <vector>

#include "models/dynamometer/boundary.h"

namespace sinew {

/// The solution of one stage in plain numbers, with the slopes from which derivatives follow: g is the
/// imbalance of a fibre, R that of the foot.
struct StageSolution {
  double angle = 0;             ///< of the ankle [rad]
  double per_angle = 0;         ///< dR / d angle, the fibres following [N m/rad]
  double torque_per_angle = 0;  ///< of the foot's torque on the plate [N m/rad]
};
struct FibreSolution {
  double length = 0;     ///< [m]
  double inverse = 0;    ///< 1 / (dg / d length) [m/N]
  double per_angle = 0;  ///< -d length / d angle [m/rad]
  double lever = 0;      ///< (dR / d length) / (dg / d length) [m]
};

/// Slopes of one muscle's forces at the solution of a stage, length and angle kept.
struct MuscleSlopes {
  enum Of { kVelocity, kActivation, kStrength, kSlackLength, kOptimalLength, kActiveGain, kCount };
  std::array<double, kCount> imbalance{};
  std::array<double, kCount> tendon_force{};
};

/// What a plain run leaves for those with derivatives.
struct FootSolutions {
  std::vector<StageSolution> stages;
  std::vector<FibreSolution> fibres;  ///< [stages x muscles]
  std::vector<MuscleSlopes> slopes;   ///< [stages x muscles], by the first run with derivatives
};

/// Everything about one instant that a prediction may show.
template <class T>
struct FootInstant {
  T ankle_angle{0.0};
  T ankle_velocity{0.0};
  T muscle_moment{0.0};   ///< about the ankle [N m]
  T passive_moment{0.0};  ///< [N m]
  BoundaryLoad<T> boundary;
  T torque{0.0};  ///< of the foot on the plate: boundary.on_plate and what relaxes [N m]
};

}  // namespace sinew
