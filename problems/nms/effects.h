// What may be wrong with a person's muscles, joints and measurements, and the parameters of all that.
#pragma once

#include <array>
#include <vector>

#include "problems/kit/parameter_list.h"
#include "problems/nms/data.h"

namespace sinew {

/// How a parameter enters a number of a muscle.
struct NmsPlace {
  enum Way {
    kSets,    ///< slot = factor * parameter
    kScales,  ///< slot *= 1 + parameter
    kAdds     ///< slot += factor * parameter
  };
  int parameter = 0;
  int muscle = 0;
  MuscleSlot slot = kStrength;
  Way way = kSets;
  double factor = 1;
  int trial = -1;  ///< the only one in which it does; -1: all
};

/// A moment that is a parameter times something known.
struct NmsMoment {
  int parameter = 0;
  int joint = 0;
  std::vector<Vector> by_trial;  ///< [trials] [N, N m per unit of the parameter]
};

struct NmsParameterList : ParameterList {
  std::vector<NmsPlace>
      places;  ///< those that set come before those that scale, and these before those that add
  std::vector<NmsMoment> moments;
  std::vector<int> arm_offset;  ///< [joints] parameter, or -1
};

/// The base parameters of the settings, then the effects.
/// @param rest [muscles] of the subject
[[nodiscard]] NmsParameterList ListNmsParameters(const NmsSettings& settings, const NmsData& data,
                                                 const std::vector<std::array<double, kMuscleSlots>>& rest);

}  // namespace sinew
