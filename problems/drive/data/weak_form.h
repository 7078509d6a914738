// The equation of motion of a joint, linear in its parameters, without differentiating what was measured.
#pragma once

#include <vector>

#include "problems/drive/data/motion.h"

namespace sinew {

/// Integrals over one window of time of everything the equation of motion is made of, each times a smooth
/// function that is zero at both ends.
struct WeakRow {
  double command = 0;
  double acceleration = 0;
  double speed = 0;
  double gravity = 0;         ///< sin q
  double gravity_across = 0;  ///< cos q
  double direction = 0;       ///< of motion, from -1 to 1
  double position = 0;
  double one = 0;
};

/// The equation of motion times smooth windows of about 0.4 s, integrated by parts until nothing measured is
/// differentiated. Windows overlap by three quarters. Source: Preisig & Rippin, Theory and application of the
/// modulating function method, Comput. Chem. Eng. 17 (1993).
/// @param electric damping by the motor is part of the equation: only windows in which it is on
/// @param slow speed [rad/s] below which the direction is uncertain
/// @param angle_unit [rad] of the numbers of position, as far as gravity is concerned
[[nodiscard]] std::vector<WeakRow> WeakRows(const DriveCommand& command, bool electric,
                                            const std::vector<DriveMotion>& motions, double slow,
                                            double angle_unit = 1);

}  // namespace sinew
