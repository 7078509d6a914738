#include "problems/contact/stiffness_modes.h"

#include <algorithm>

namespace sinew {

StiffnessModes StiffnessModesAt(double ahead, double outward) {
  const double along = std::clamp(ahead, -1.0, 1.0);
  const double across = std::clamp(outward, -1.0, 1.0);
  // 1/3 is the mean of the square from -1 to 1.
  return {0.5 * along, 1.0 / 3 - along * along, 0.5 * across};
}

std::vector<StiffnessModes> StiffnessModesOf(const std::vector<double>& ahead,
                                             const std::vector<double>& outward, double length,
                                             double width) {
  std::vector<StiffnessModes> modes;
  modes.reserve(ahead.size());
  for (std::size_t i = 0; i < ahead.size(); ++i)
    modes.push_back(StiffnessModesAt(2 * ahead[i] / length, 2 * outward[i] / width));
  return modes;
}

}  // namespace sinew
