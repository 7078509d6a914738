#include "problems/contact/steps/foot_wrench.h"

#include <algorithm>

namespace sinew {

WrenchOfLoad IntoFoot(const Stance& stance) {
  const auto of_foot = FootDirections(stance.forward, stance.side);
  const auto of_walk = FootDirections(stance.progression, stance.side);
  WrenchOfLoad into = WrenchOfLoad::Zero();
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    const auto row = static_cast<Eigen::Index>(axis);
    into.block<1, 3>(row, 0) = of_walk[kShiftX + axis].segment<3>(kShiftX).transpose();
    into.block<1, 3>(row + 3, 3) = of_foot[kTurnX + axis].segment<3>(kTurnX).transpose();
  }
  return into;
}

WrenchOfLoad WrenchAbout(const Vec3& place) {
  WrenchOfLoad wrench = WrenchOfLoad::Zero();
  wrench(0, kForceX) = wrench(1, kForceY) = wrench(2, kForceZ) = 1;
  wrench(3, kFirstMomentZ) = -1;
  wrench(3, kForceY) = place.z();
  wrench(4, kMomentY) = 1;
  wrench(4, kForceX) = -place.z();
  wrench(4, kForceZ) = place.x();
  wrench(5, kFirstMomentX) = 1;
  wrench(5, kForceY) = -place.x();
  return wrench;
}

Wrench WrenchCurve::At(double at) const {
  std::size_t after = 0;
  while (after + 1 < share.size() && share[after] < at) ++after;
  const std::size_t before = after == 0 ? 0 : after - 1;
  const double length = share[after] - share[before];
  const double part = length > 0 ? std::clamp((at - share[before]) / length, 0.0, 1.0) : 1;
  return (1 - part) * wrench[before] + part * wrench[after];
}

bool IsLoaded(const Stance& stance, std::size_t instant) {
  return stance.time[instant] >= stance.loaded[0] && stance.time[instant] <= stance.loaded[1];
}

}  // namespace sinew
