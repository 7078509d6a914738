// A foot that stands flat on the floor has its sole at one height in every stance; what is recorded differs
// by millimetres to centimetres, since every foot's markers and model have errors of their own.
#pragma once

#include <vector>

#include "problems/contact/stance.h"

namespace sinew {

/// Raises or lowers the recorded motion of every stance so that the sole's centre is at the same height, that
/// of the training stances' mean, while the foot is flat: the median over 20 to 45 % of the stance (foot flat
/// to heel rise; Perry, Burnfield 2010, Gait Analysis, ch. 4). Without a training stance all count.
/// @return [stances, m] by how much each was raised
std::vector<double> LevelFeet(std::vector<Stance>& stances);

}  // namespace sinew
