// What is known of a foot that is strapped to the plate of a dynamometer. SCIENCE section 6.
//
// Everything lies in the sagittal plane. The shank is fixed: x points forward, y along the shank to the knee,
// the origin is the ankle. The ankle's angle q turns the foot about it, dorsiflexion is positive; the
// machine's angle p turns the plate about the machine's axis in the same direction. At p = 0 and q = 0 the
// plate, the sole and x are parallel.
#pragma once

#include <vector>

namespace sinew {

/// A strap that holds the foot down: it runs from the plate over the foot and pulls the foot's point towards
/// the plate's point.
struct FootStrap {
  double foot_x = 0;   ///< on the foot, from the ankle [m]
  double foot_y = 0;   ///< [m]
  double plate_x = 0;  ///< on the plate, from the machine's axis [m]; its height is the plate's
};

struct FootGeometry {
  double ankle_height = 0.08;         ///< of the ankle over the sole [m, > 0]
  double heel = 0.05;                 ///< length of the sole behind the ankle [m, > 0]
  double toe = 0.17;                  ///< length of the sole before the ankle [m, > 0]
  double width = 0.08;                ///< of the sole [m, > 0]
  double mass = 1.1;                  ///< of the foot [kg, >= 0]
  double mass_x = 0.05;               ///< centre of mass from the ankle, in the foot [m]
  double mass_y = -0.04;              ///< [m]
  double inertia = 0.008;             ///< of the foot about the ankle [kg m2, > 0]
  std::vector<FootStrap> straps;      ///< default: DefaultStraps
  int strips = 16;                    ///< springs along the sole [1..1000]
  double transition_velocity = 0.02;  ///< of friction [m/s, > 0]
  double gravity = 9.81;              ///< [m/s2]
  double shank_tilt = 0;              ///< of the shank from the vertical, the knee forward [rad]
};

/// One over the forefoot and one before the ankle.
[[nodiscard]] inline std::vector<FootStrap> DefaultStraps() {
  return {{0.11, -0.03, 0.11}, {0.02, 0.0, 0.035}};
}

}  // namespace sinew
