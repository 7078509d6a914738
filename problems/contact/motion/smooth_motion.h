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
/// fixed to the first body.
///
/// A motion without noise that its samples could show stays as it is, by generalised cross-validation of
/// splines that could follow every sample (Craven, Wahba 1979; for movements Woltring 1986): a sharp cutoff
/// rings next to every change of the speed by a tenth of a millimetre per second, which is ten newtons of a
/// foot that sticks.
/// @param times [T, s] of the foot's motion
void SmoothMotion(const std::vector<double>& times, double lowest, FootMotion& foot);

}  // namespace sinew
