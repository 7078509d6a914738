// How the stiffness of a sole's springs may vary with their place under the foot.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace sinew {

/// Of the natural logarithm of the stiffness: from heel to toes, in the middle against both ends, and from
/// the inner to the outer edge.
constexpr std::size_t kStiffnessModes = 3;
using StiffnessModes = std::array<double, kStiffnessModes>;

/// A spring's share of each mode. The values of the modes are logarithms of ratios: toes over heel, middle
/// over both ends, outer over inner edge. None changes the mean of the logarithm along or across the sole.
/// @param ahead of the sole's middle, over half its length; beyond -1 and 1 as there
/// @param outward of it, over half its width
[[nodiscard]] StiffnessModes StiffnessModesAt(double ahead, double outward);

/// StiffnessModesAt every spring. @param ahead, outward of the sole's middle [springs, m]
/// @param length, width of the sole [m]
[[nodiscard]] std::vector<StiffnessModes> StiffnessModesOf(const std::vector<double>& ahead,
                                                           const std::vector<double>& outward, double length,
                                                           double width);

}  // namespace sinew
