#include "problems/contact/motion/progression.h"

#include <cmath>

namespace sinew {

Status FindProgression(const CoordinateTrajectory& motion, const MultibodyModel& model, int root,
                       const Floor& floor, Stance& stance) {
  stance.progression = stance.forward;
  const auto [begin, end] = stance.loaded;
  SINEW_ASSIGN(const auto motions, model.BodyMotions({begin, end}, motion, {root}));
  const Vec3 belt(floor.velocity_x, 0, floor.velocity_z);
  Vec3 way = motions.back().front().position - motions.front().front().position - (end - begin) * belt;
  way.y() = 0;
  if (way.norm() < 0.5 * stance.length) return {};
  const Vec3 direction = way.normalized();
  if (direction.dot(stance.forward) > std::sqrt(0.5)) stance.progression = direction;
  return {};
}

}  // namespace sinew
