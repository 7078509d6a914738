// The recorded motion of a foot without the frequencies that no error of it can have: what is faster is noise
// of markers, which friction turns into large forces.
#pragma once

#include <vector>

#include "problems/contact/motion/foot_motion.h"

namespace sinew {

/// Replaces position and rotation of every body by least-squares cubic B-splines with knots half a period of
/// a cutoff apart, and the velocities by their derivatives. The cutoff is the one that generalised
/// cross-validation of the first body's pose prefers, from `lowest` on. Rotations are rotation vectors about
/// the pose in the middle, which must differ from all others by less than half a turn. The joint's axes stay
/// fixed to the first body. @param times [T, s] of the foot's motion
void SmoothMotion(const std::vector<double>& times, double lowest, FootMotion& foot);

}  // namespace sinew
