// What kind of joint and drive a data set is about, and what is known of it.
#pragma once

#include "problems/drive/data/data.h"

namespace sinew {

/// Fills the traits, the joint and the command of `out` but for what depends on the motion.
/// Errors: no input or two, units that are neither rotary nor linear, nothing measured, a constant out of its
/// range, a reference without controller or the other way round.
Status FindTraits(const Dataset& data, const DriveSettings& settings, DriveData& out);

}  // namespace sinew
