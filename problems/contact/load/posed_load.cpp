#include "problems/contact/load/posed_load.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "problems/contact/load/spring_force.h"

namespace sinew {
namespace {

// One instant's room in the arrays of a region; the areas stay.
EffectRegion OneInstant(const EffectRegion& recorded) {
  EffectRegion region;
  region.part = recorded.part;
  region.turning_x = region.turning_z = {0.0};
  region.ahead = recorded.ahead;
  region.stiffness_modes = recorded.stiffness_modes;
  ContactKinematics& k = region.kinematics;
  k.instants = 1;
  k.faces = recorded.kinematics.faces;
  k.area = recorded.kinematics.area;
  for (auto* array : {&k.depth, &k.rate, &k.slip_x, &k.slip_z, &k.point_x, &k.point_z})
    array->assign(static_cast<std::size_t>(k.faces), 0.0);
  return region;
}

// Columns of the derivatives of a region's load: what moves its body (position, rotation, velocity and
// angular velocity, three each), the place of its sole, and its bed's five parameters.
constexpr std::size_t kMotionColumns = 12;
constexpr std::size_t kPlaceColumns = kMotionColumns;
constexpr std::size_t kBedColumns = kPlaceColumns + kSolePlaces;
constexpr std::size_t kColumns = kBedColumns + 5;
using Columns = std::array<double, kColumns>;

// Sums over the springs of a region of the derivatives of its load.
struct RegionDerivatives {
  std::array<Columns, 6> rows{};  // of a ContactLoad

  // Those of one spring's force along x, y, z, which acts at x, z.
  void AddForce(const std::array<Columns, 3>& force, double x, double z) {
    for (std::size_t c = 0; c < kColumns; ++c) {
      rows[kForceX][c] += force[0][c];
      rows[kForceY][c] += force[1][c];
      rows[kForceZ][c] += force[2][c];
      rows[kMomentY][c] += z * force[0][c] - x * force[2][c];
      rows[kFirstMomentX][c] += x * force[1][c];
      rows[kFirstMomentZ][c] += z * force[1][c];
    }
  }
  // A force that moves by so much along x and z per unit of the column.
  void AddPlace(std::size_t column, double along_x, double along_z, const Vec3& force) {
    rows[kMomentY][column] += along_z * force.x() - along_x * force.z();
    rows[kFirstMomentX][column] += along_x * force.y();
    rows[kFirstMomentZ][column] += along_z * force.y();
  }
};

// One spring that touches.
struct TouchingSpring {
  double normal = 0;  // force [N]
  double by_depth = 0;
  double by_rate = 0;
  double by_stiffness = 0;
  double by_dissipation = 0;
  double slip_x = 0;
  double slip_z = 0;
  double drag = 0;  // friction per unit of normal force and of slip
  double drag_slope = 0;
  std::array<double, 3> friction{};  // drag for each coefficient
};

// @param axes along which the sole may lie elsewhere, in columns, in ground axes @param lever_y of the floor
// over the body's origin
void AddDerivatives(const TouchingSpring& s, const Vec3& arm, const Vec3& spin, double lever_y,
                    const Mat3& axes, double x, double z, RegionDerivatives& sums) {
  const Vec3 unit(-s.drag * s.slip_x, 1, -s.drag * s.slip_z);
  // The force for the velocity at the floor and for the depth.
  const double cross = -s.normal * s.drag_slope * s.slip_x * s.slip_z;
  const Vec3 vx(-s.normal * (s.drag + s.drag_slope * s.slip_x * s.slip_x), 0, cross);
  const Vec3 vz(cross, 0, -s.normal * (s.drag + s.drag_slope * s.slip_z * s.slip_z));
  std::array<Columns, 3> force;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    Columns& f = force[i];
    const double by_vx = vx[axis];
    const double by_vy = -s.by_rate * unit[axis];
    const double by_vz = vz[axis];
    // For the lever of that velocity along x and z, by which the place of the spring acts too.
    const double by_x = by_vy * spin.z() - by_vz * spin.y();
    const double by_y = -s.by_depth * unit[axis];
    const double by_z = by_vx * spin.y() - by_vy * spin.x();
    f[0] = 0;
    f[1] = by_y - (by_vz * spin.x() - by_vx * spin.z());
    f[2] = 0;
    f[3] = arm.y() * by_z - arm.z() * by_y;
    f[4] = arm.z() * by_x - arm.x() * by_z;
    f[5] = arm.x() * by_y - arm.y() * by_x;
    f[6] = by_vx;
    f[7] = by_vy;
    f[8] = by_vz;
    f[9] = lever_y * by_vz - arm.z() * by_vy;
    f[10] = arm.z() * by_vx - arm.x() * by_vz;
    f[11] = arm.x() * by_vy - lever_y * by_vx;
    for (Eigen::Index p = 0; p < kSolePlaces; ++p)
      f[kPlaceColumns + static_cast<std::size_t>(p)] =
          axes(0, p) * by_x + axes(1, p) * by_y + axes(2, p) * by_z;
    f[kBedColumns] = s.by_stiffness * unit[axis];
    f[kBedColumns + 1] = s.by_dissipation * unit[axis];
    const double along = i == 0 ? s.slip_x : i == 2 ? s.slip_z : 0;
    for (std::size_t j = 0; j < 3; ++j) f[kBedColumns + 2 + j] = -s.normal * s.friction[j] * along;
  }
  sums.AddForce(force, x, z);
  const Vec3 own = s.normal * unit;
  sums.AddPlace(0, 1, 0, own);
  sums.AddPlace(2, 0, 1, own);
  sums.AddPlace(3, 0, arm.y(), own);
  sums.AddPlace(4, arm.z(), -arm.x(), own);
  sums.AddPlace(5, -arm.y(), 0, own);
  for (Eigen::Index p = 0; p < kSolePlaces; ++p)
    sums.AddPlace(kPlaceColumns + static_cast<std::size_t>(p), axes(0, p), axes(2, p), own);
}

}  // namespace

PosedFoot::PosedFoot(const EffectKinematics& recorded) {
  for (const EffectRegion& region : recorded.regions) posed_.regions.push_back(OneInstant(region));
  for (std::size_t edge = 0; edge < recorded.edges.size(); ++edge) {
    for (const EffectRegion& region : recorded.edges[edge]) posed_.edges[edge].push_back(OneInstant(region));
  }
  posed_.foot_position.resize(1);
  posed_.foot_acceleration.resize(1);
  posed_.phase.resize(recorded.phase.empty() ? 0 : 1);
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
  if (!recorded.phase.empty()) posed_.phase[0] = recorded.phase[t];
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

void PosedFoot::ComputeLoad(const FootMotion& foot, const std::vector<ElasticFoundation>& beds,
                            bool derivatives, EffectLoad& load, ContactPoseJacobian& by_pose,
                            std::vector<ContactPlaceJacobian>& by_place) const {
  load.load.setZero();
  if (derivatives) {
    for (ContactLoadJacobian& jacobian : load.by_part) jacobian.setZero();
    by_pose.setZero();
    for (ContactPlaceJacobian& jacobian : by_place) jacobian.setZero();
  }
  for (std::size_t r = 0; r < posed_.regions.size(); ++r) {
    const EffectRegion& region = posed_.regions[r];
    const ContactKinematics& k = region.kinematics;
    const auto part = static_cast<std::size_t>(region.part);
    const ElasticFoundation& bed = beds[part];
    const FootMotion::Springs& springs = foot.springs[r];
    const auto b = static_cast<std::size_t>(springs.body);
    const BodyMotion& body = motion_[b];
    Mat3 axes = body.rotation * springs.axes;
    axes.col(kSoleOutward) *= side_;
    const Vec3 moved = springs.Moved(sole_place_[part], side_);
    const double lever_y = floor_height_ - body.position.y();
    RegionDerivatives sums;
    for (std::size_t f = 0; f < springs.position.size(); ++f) {
      if (!(k.depth[f] > 0)) continue;
      // Thesis eq 5.1.
      const double damped = 1 + bed.dissipation * k.rate[f];
      if (!(damped > 0)) continue;
      const double area = k.area[f];
      TouchingSpring s;
      s.normal = area * bed.stiffness * k.depth[f] * damped;
      s.slip_x = k.slip_x[f];
      s.slip_z = k.slip_z[f];
      const FrictionPerSlip friction =
          FrictionPerSlipAt(std::sqrt(s.slip_x * s.slip_x + s.slip_z * s.slip_z), posed_.transition_velocity);
      const std::array<double, 3> mu{bed.static_friction, bed.dynamic_friction, bed.viscous_friction};
      for (std::size_t j = 0; j < 3; ++j) {
        s.drag += mu[j] * friction.value[j];
        s.drag_slope += mu[j] * friction.slope[j];
      }
      const Lever lever{k.point_x[f], k.point_z[f]};
      load.load += s.normal * lever.Of(-s.drag * s.slip_x, 1, -s.drag * s.slip_z);
      if (!derivatives) continue;
      s.by_depth = area * bed.stiffness * damped;
      s.by_rate = area * bed.stiffness * k.depth[f] * bed.dissipation;
      s.by_stiffness = area * k.depth[f] * damped;
      s.by_dissipation = area * bed.stiffness * k.depth[f] * k.rate[f];
      s.friction = friction.value;
      AddDerivatives(s, body.rotation * (springs.position[f] + moved), body.angular_velocity, lever_y, axes,
                     lever.x, lever.z, sums);
    }
    if (!derivatives) continue;
    for (Eigen::Index row = 0; row < 6; ++row) {
      const Columns& of_row = sums.rows[static_cast<std::size_t>(row)];
      by_pose.row(row) +=
          Eigen::Map<const Eigen::Matrix<double, 1, kMotionColumns>>(of_row.data()) * jacobians_[b];
      for (Eigen::Index p = 0; p < kSolePlaces; ++p)
        by_place[part](row, p) += of_row[kPlaceColumns + static_cast<std::size_t>(p)];
      for (std::size_t c = 0; c < 5; ++c)
        load.by_part[part](row, static_cast<Eigen::Index>(c)) += of_row[kBedColumns + c];
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
