// What is hidden in synthetic contact data: effects of the contact, and what the plates do to their readings.
#pragma once

#include <array>

#include "base/error.h"
#include "problems/contact/effects.h"
#include "problems/synthesis_request.h"

namespace sinew {

/// What the export of a plate does to one component of the force.
struct PlateDistortion {
  double offset = 0;  ///< [N]
  double gain = 1;
  double time_offset = 0;  ///< [s] the plate's clock is late
  double drift = 0;        ///< [N/s] about the middle of the stance
};

struct ContactTruth {
  ContactEffectValues effects{};
  std::array<double, 2> own_height{};                      ///< right, left [m]
  std::array<std::array<PlateDistortion, 3>, 2> plates{};  ///< right, left; x, y, z

  /// Effects as the plate of this side feels them.
  [[nodiscard]] ContactEffectValues EffectsOn(bool right) const;
};

/// Effects of the contact by the names that the problem gives them (height_offset, right.height_offset,
/// tilted_floor, ...), those of plates as CHANNEL.offset, .drift, .gain, .time_offset with CHANNEL such as
/// right_force_y; without right_ or left_ both plates do it.
/// Errors: those of ReadHiddenEffects.
Result<ContactTruth> ReadContactTruth(const RequestedEffects& effects);

}  // namespace sinew
