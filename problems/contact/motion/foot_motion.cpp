#include "problems/contact/motion/foot_motion.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>

namespace sinew {
namespace {

// The axis about which a coordinate turns body `other` against body `first`, if it does.
Result<JointAxis> AxisOf(const MultibodyModel& model, const Vector& values, int coordinate, int first,
                         int other) {
  constexpr double kStill = 1e-9;  // [rad/s] of a unit rate
  Vector rates = Vector::Zero(values.size());
  rates[coordinate] = 1;
  SINEW_ASSIGN(const auto moving, model.BodyMotionAt(values, rates, {first, other}));
  const Vec3 spin = moving[1].angular_velocity - moving[0].angular_velocity;
  if (spin.norm() < kStill) return JointAxis{};
  const Vec3 carried =
      moving[0].velocity + moving[0].angular_velocity.cross(moving[1].position - moving[0].position);
  const Vec3 velocity = moving[1].velocity - carried;
  return JointAxis{spin.normalized(), moving[1].position + spin.cross(velocity) / spin.squaredNorm()};
}

// The one coordinate that turns `other` against `first`; nothing if there is none or several.
Result<std::optional<int>> JointBetween(const MultibodyModel& model, const Vector& values, int first,
                                        int other) {
  std::optional<int> found;
  for (int c = 0; c < static_cast<int>(model.coordinate_names().size()); ++c) {
    if (model.IsDependent(c)) continue;
    SINEW_ASSIGN(const JointAxis axis, AxisOf(model, values, c, first, other));
    if (axis.direction.isZero()) continue;
    if (found) return std::optional<int>();
    found = c;
  }
  return found;
}

}  // namespace

Result<FootMotion> RecordedFootMotion(const std::vector<double>& times, const CoordinateTrajectory& motion,
                                      const MultibodyModel& model, const std::vector<FootRegion>& regions) {
  FootMotion foot;
  for (const FootRegion& region : regions) foot.indices.push_back(region.body);
  std::sort(foot.indices.begin(), foot.indices.end());
  foot.indices.erase(std::unique(foot.indices.begin(), foot.indices.end()), foot.indices.end());
  foot.bodies.resize(foot.indices.size());

  SINEW_ASSIGN(const auto motions, model.BodyMotions(times, motion, foot.indices));
  for (const auto& at_instant : motions) {
    for (std::size_t b = 0; b < foot.bodies.size(); ++b) foot.bodies[b].motion.push_back(at_instant[b]);
  }
  const Vector first_values = motion.At(times.front()).values;
  for (std::size_t b = 0; b < foot.bodies.size(); ++b) {
    FootMotion::Body& body = foot.bodies[b];
    body.axis.resize(times.size());
    if (b == 0) continue;
    SINEW_ASSIGN(const auto joint, JointBetween(model, first_values, foot.indices[0], foot.indices[b]));
    if (!joint) continue;
    foot.has_joint = true;
    for (std::size_t t = 0; t < times.size(); ++t) {
      SINEW_ASSIGN(body.axis[t],
                   AxisOf(model, motion.At(times[t]).values, *joint, foot.indices[0], foot.indices[b]));
    }
  }

  for (const FootRegion& region : regions) {
    FootMotion::Springs springs;
    springs.body = static_cast<int>(std::find(foot.indices.begin(), foot.indices.end(), region.body) -
                                    foot.indices.begin());
    springs.axes = region.region->rotation;
    for (const int face : region.region->SpringFaceIndices()) {
      springs.position.emplace_back(region.region->position +
                                    region.region->rotation * region.region->mesh.Centre(face));
    }
    foot.springs.push_back(std::move(springs));
  }

  foot.SetCentre(0);
  return foot;
}

void FootMotion::SetCentre(std::size_t instant) {
  Vec3 sum = Vec3::Zero();
  std::size_t count = 0;
  for (const Springs& region : springs) {
    const BodyMotion& body = bodies[static_cast<std::size_t>(region.body)].motion[instant];
    for (const Vec3& position : region.position) sum += body.position + body.rotation * position;
    count += region.position.size();
  }
  const BodyMotion& first = bodies.front().motion[instant];
  centre_B = first.rotation.transpose() * (sum / static_cast<double>(count) - first.position);
  PlaceCentre();
}

void FootMotion::Raise(double height) {
  for (Body& body : bodies) {
    for (BodyMotion& motion : body.motion) motion.position.y() += height;
    for (JointAxis& axis : body.axis) axis.point.y() += height;
  }
  PlaceCentre();
}

FootMotion FootMotion::Part(std::size_t first, std::size_t last) const {
  const auto cut = [&](auto& values) {
    values.erase(values.begin() + static_cast<std::ptrdiff_t>(last), values.end());
    values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(first));
  };
  FootMotion part = *this;
  for (Body& body : part.bodies) {
    cut(body.motion);
    cut(body.axis);
  }
  cut(part.centre);
  cut(part.centre_velocity);
  return part;
}

void FootMotion::TakeOver(const FootMotion& part, std::size_t first) {
  const FootMotion before = *this;
  const std::size_t last = first + part.centre.size() - 1;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    for (std::size_t t = 0; t < centre.size(); ++t) {
      if (t >= first && t <= last) {
        bodies[b].motion[t] = part.bodies[b].motion[t - first];
        bodies[b].axis[t] = part.bodies[b].axis[t - first];
        continue;
      }
      const std::size_t end = t < first ? first : last;
      const BodyMotion& from = before.bodies[b].motion[end];
      const BodyMotion& to = part.bodies[b].motion[end - first];
      const Mat3 turn = to.rotation * from.rotation.transpose();
      const Vec3 shift = to.position - from.position;
      BodyMotion& motion = bodies[b].motion[t];
      motion.position += shift;
      motion.rotation = turn * motion.rotation;
      motion.angular_velocity = turn * motion.angular_velocity;
      JointAxis& axis = bodies[b].axis[t];
      axis.direction = turn * axis.direction;
      axis.point = motion.position + turn * (axis.point + shift - motion.position);
    }
  }
  PlaceCentre();
}

void FootMotion::PlaceCentre() {
  centre.clear();
  centre_velocity.clear();
  for (const BodyMotion& body : bodies.front().motion) {
    const Vec3 arm = body.rotation * centre_B;
    centre.emplace_back(body.position + arm);
    centre_velocity.emplace_back(body.velocity + body.angular_velocity.cross(arm));
  }
}

BodyMotion DeviatedBody(const FootMotion& foot, std::size_t body, std::size_t instant,
                        const PoseDeviation& deviation, const FootTurn& turn, PoseJacobian* jacobian) {
  const FootMotion::Body& of = foot.bodies[body];
  return DeviatedMotion(deviation, turn, of.motion[instant], of.axis[instant], foot.centre[instant],
                        foot.centre_velocity[instant], jacobian);
}

}  // namespace sinew
