#include "problems/contact/posed_load.h"

#include <Eigen/Geometry>

namespace sinew {
namespace {

// One instant's room in the arrays of a region; the areas stay.
EffectRegion OneInstant(const EffectRegion& recorded) {
  EffectRegion region{recorded.part, {}, {0.0}, {0.0}};
  ContactKinematics& k = region.kinematics;
  k.instants = 1;
  k.faces = recorded.kinematics.faces;
  k.area = recorded.kinematics.area;
  for (auto* array : {&k.depth, &k.rate, &k.slip_x, &k.slip_z, &k.point_x, &k.point_z})
    array->assign(static_cast<std::size_t>(k.faces), 0.0);
  return region;
}

}  // namespace

PosedFoot::PosedFoot(const EffectKinematics& recorded) {
  for (const EffectRegion& region : recorded.regions) posed_.regions.push_back(OneInstant(region));
  for (std::size_t edge = 0; edge < recorded.edges.size(); ++edge) {
    for (const EffectRegion& region : recorded.edges[edge]) posed_.edges[edge].push_back(OneInstant(region));
  }
  posed_.foot_position.resize(1);
  posed_.foot_acceleration.resize(1);
  posed_.tilt_reference = recorded.tilt_reference;
  posed_.floor_velocity = recorded.floor_velocity;
  posed_.transition_velocity = recorded.transition_velocity;
}

const EffectRegion& PosedFoot::Region(std::size_t index) const {
  if (index < posed_.regions.size()) return posed_.regions[index];
  index -= posed_.regions.size();
  const std::size_t toes = posed_.edges[0].size();
  return index < toes ? posed_.edges[0][index] : posed_.edges[1][index - toes];
}

EffectRegion& PosedFoot::Region(std::size_t index) {
  return const_cast<EffectRegion&>(static_cast<const PosedFoot&>(*this).Region(index));  // NOLINT
}

void PosedFoot::Place(const EffectKinematics& recorded, const FootMotion& foot, double floor_height,
                      int instant, const PoseDeviation& deviation, const std::vector<Vec3>& sole_place,
                      double side, bool derivatives) {
  const auto t = static_cast<std::size_t>(instant);
  // The mass that a plate feels besides the springs moves as recorded.
  posed_.foot_position[0] = recorded.foot_position[t];
  posed_.foot_acceleration[0] = recorded.foot_acceleration[t];
  sole_place_ = sole_place;
  side_ = side;
  floor_height_ = floor_height;
  motion_.resize(foot.bodies.size());
  jacobians_.resize(foot.bodies.size());
  const FootTurn turn(deviation);
  for (std::size_t b = 0; b < foot.bodies.size(); ++b)
    motion_[b] = DeviatedBody(foot, b, t, deviation, turn, derivatives ? &jacobians_[b] : nullptr);

  for (std::size_t r = 0; r < foot.springs.size(); ++r) {
    const FootMotion::Springs& springs = foot.springs[r];
    const BodyMotion& body = motion_[static_cast<std::size_t>(springs.body)];
    EffectRegion& region = Region(r);
    ContactKinematics& k = region.kinematics;
    region.turning_x[0] = body.angular_velocity.x();
    region.turning_z[0] = body.angular_velocity.z();
    const Vec3 moved = springs.Moved(sole_place[static_cast<std::size_t>(region.part)], side);
    for (std::size_t f = 0; f < springs.position.size(); ++f) {
      const Vec3 arm = body.rotation * (springs.position[f] + moved);
      const Vec3 lever(arm.x(), floor_height - body.position.y(), arm.z());
      const Vec3 velocity = body.velocity + body.angular_velocity.cross(lever);
      k.depth[f] = lever.y() - arm.y();
      k.rate[f] = -velocity.y();
      k.slip_x[f] = velocity.x() - posed_.floor_velocity[0];
      k.slip_z[f] = velocity.z() - posed_.floor_velocity[1];
      k.point_x[f] = body.position.x() + arm.x();
      k.point_z[f] = body.position.z() + arm.z();
    }
  }
}

void PosedFoot::Differentiate(const FootMotion& foot, const EffectLoad& load, ContactPoseJacobian& by_pose,
                              std::vector<ContactPlaceJacobian>& by_place) const {
  by_pose.setZero();
  for (ContactPlaceJacobian& jacobian : by_place) jacobian.setZero();
  for (std::size_t r = 0; r < foot.springs.size(); ++r) {
    const FootMotion::Springs& springs = foot.springs[r];
    const auto b = static_cast<std::size_t>(springs.body);
    const BodyMotion& body = motion_[b];
    const Vec3& spin = body.angular_velocity;
    const EffectRegion& region = Region(r);
    const auto part = static_cast<std::size_t>(region.part);
    Mat3 axes = body.rotation * springs.axes;
    axes.col(kSoleOutward) *= side_;
    const Vec3 moved = springs.Moved(sole_place_[part], side_);
    Eigen::Matrix<double, 6, 12> by_motion = Eigen::Matrix<double, 6, 12>::Zero();
    for (std::size_t f = 0; f < springs.position.size(); ++f) {
      const SpringGradient& g = load.by_spring[r][f];
      if (g.isZero(0)) continue;
      const Vec3 arm = body.rotation * (springs.position[f] + moved);
      const Vec3 lever(arm.x(), floor_height_ - body.position.y(), arm.z());
      // The load for the velocity at the floor; for the lever of that velocity; for the spring's place, by
      // which the lever moves along x and z too.
      const ContactLoad vx = g.col(kSlipX);
      const ContactLoad vy = -g.col(kRate);
      const ContactLoad vz = g.col(kSlipZ);
      const ContactLoad lever_x = vy * spin.z() - vz * spin.y();
      const ContactLoad lever_y = vz * spin.x() - vx * spin.z();
      const ContactLoad lever_z = vx * spin.y() - vy * spin.x();
      const ContactLoad x = g.col(kPointX) + lever_x;
      const ContactLoad y = -g.col(kDepth);
      const ContactLoad z = g.col(kPointZ) + lever_z;
      by_motion.col(0) += g.col(kPointX);
      by_motion.col(1) += y - lever_y;
      by_motion.col(2) += g.col(kPointZ);
      by_motion.col(3) += arm.y() * z - arm.z() * y;
      by_motion.col(4) += arm.z() * x - arm.x() * z;
      by_motion.col(5) += arm.x() * y - arm.y() * x;
      by_motion.col(6) += vx;
      by_motion.col(7) += vy;
      by_motion.col(8) += vz;
      by_motion.col(9) += lever.y() * vz - lever.z() * vy + g.col(kTurningX);
      by_motion.col(10) += lever.z() * vx - lever.x() * vz;
      by_motion.col(11) += lever.x() * vy - lever.y() * vx + g.col(kTurningZ);
      for (int place = 0; place < kSolePlaces; ++place)
        by_place[part].col(place) += axes(0, place) * x + axes(1, place) * y + axes(2, place) * z;
    }
    by_pose += by_motion * jacobians_[b];
  }
}

}  // namespace sinew
