#include "models/contact/elastic_foundation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace sinew {

std::vector<int> ContactRegion::SpringFaceIndices() const {
  constexpr double kMaxDownwardNormal = -0.5;  // within 60 degrees of straight down
  std::vector<int> faces;
  for (int face = 0; face < mesh.face_count(); ++face) {
    if (springs == SpringFaces::kAll || mesh.Normal(face).y() < kMaxDownwardNormal) faces.push_back(face);
  }
  return faces;
}

ContactKinematics ComputeContactKinematics(const ContactRegion& region, const std::vector<BodyMotion>& motion,
                                           const Floor& floor) {
  ContactKinematics k;
  k.instants = static_cast<int>(motion.size());
  const std::vector<int> faces = region.SpringFaceIndices();
  k.faces = static_cast<int>(faces.size());
  const std::size_t size = motion.size() * static_cast<std::size_t>(k.faces);
  for (auto* array : {&k.depth, &k.rate, &k.slip_x, &k.slip_z, &k.point_x, &k.point_z}) array->reserve(size);

  std::vector<Vec3> springs;  // in the frame of the body
  for (const int face : faces) {
    k.area.push_back(region.mesh.Area(face));
    springs.emplace_back(region.position + region.rotation * region.mesh.Centre(face));
  }
  for (const BodyMotion& body : motion) {
    for (const Vec3& spring_B : springs) {
      const Vec3 spring = body.position + body.rotation * spring_B;
      const Vec3 nearest(spring.x(), floor.height, spring.z());
      const Vec3 velocity = body.velocity + body.angular_velocity.cross(nearest - body.position);
      k.depth.push_back(floor.height - spring.y());
      k.rate.push_back(-velocity.y());
      k.slip_x.push_back(velocity.x() - floor.velocity_x);
      k.slip_z.push_back(velocity.z() - floor.velocity_z);
      k.point_x.push_back(nearest.x());
      k.point_z.push_back(nearest.z());
    }
  }
  return k;
}

ContactWrench ContactWrenchAt(const ContactKinematics& kinematics, int instant, const ElasticFoundation& p,
                              double transition_velocity, std::vector<FaceLoad>* loads) {
  ContactWrench wrench;
  if (loads != nullptr) loads->assign(static_cast<std::size_t>(kinematics.faces), {});
  for (int face = 0; face < kinematics.faces; ++face) {
    const auto i = static_cast<std::size_t>(instant) * static_cast<std::size_t>(kinematics.faces) +
                   static_cast<std::size_t>(face);
    const auto f = static_cast<std::size_t>(face);
    const double slip = std::hypot(kinematics.slip_x[i], kinematics.slip_z[i]);
    if (loads != nullptr) (*loads)[f].slip = slip;
    if (kinematics.depth[i] <= 0) continue;
    const double normal =
        p.stiffness * kinematics.area[f] * kinematics.depth[i] * (1 + p.dissipation * kinematics.rate[i]);
    if (normal <= 0) continue;

    Vec3 force(0, normal, 0);
    if (slip > 0) {
      const double ratio = slip / transition_velocity;
      const double friction =
          normal *
          (std::min(ratio, 1.0) *
               (p.dynamic_friction + 2 * (p.static_friction - p.dynamic_friction) / (1 + ratio * ratio)) +
           p.viscous_friction * slip);
      force.x() = -friction * kinematics.slip_x[i] / slip;
      force.z() = -friction * kinematics.slip_z[i] / slip;
    }
    wrench.force += force;
    wrench.moment += Vec3(kinematics.point_x[i], 0, kinematics.point_z[i]).cross(force);
    if (loads != nullptr) (*loads)[f].pressure = normal / kinematics.area[f];
  }
  return wrench;
}

}  // namespace sinew
