// Where the true sole differs from the recorded one by the same function of the phase in all stances.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace sinew {

/// How a sole can be displaced: what is in front of its middle turns up, all of it turns up about its middle,
/// all of it is higher.
enum ShapeMode : std::size_t { kBend, kPitch, kLift, kShapeModes };

/// Values of each mode at a quarter, the middle and three quarters of the time that the foot is loaded.
constexpr std::size_t kShapePhases = 3;

/// Of each of these values, its share of the mode and the rate of that at one instant.
struct PhaseShare {
  std::array<double, kShapePhases> value{};  ///< [1]
  std::array<double, kShapePhases> rate{};   ///< [1/s]
};

/// Half cosine waves from one value to the next, and from and to nothing where the load begins and ends: the
/// mode and its rate are continuous. @param loaded from, to [s]
[[nodiscard]] PhaseShare PhaseShareAt(double time, const std::array<double, 2>& loaded);

/// @param ahead of the sole's middle [m]
/// @return displacement upwards of a spring there by a unit of each mode [m/rad, m/rad, 1]
[[nodiscard]] inline std::array<double, kShapeModes> ShapeArms(double ahead) {
  return {ahead > 0 ? ahead : 0, ahead, 1};
}

/// @param along of every spring, along the foot [m]. @param heel, toe ends of the sole [m]
/// @return how far each is ahead of the middle [m]
[[nodiscard]] std::vector<double> AheadOfMiddle(const std::vector<double>& along, double heel, double toe);

}  // namespace sinew
