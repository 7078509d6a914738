#include "models/multibody/whole_body_load.h"

#include <Eigen/Geometry>
#include <numeric>

#include "models/multibody/simbody_model.h"

namespace sinew {
namespace {

struct MassProperties {
  double mass = 0;              // [kg]
  Vec3 centre = Vec3::Zero();   // in the body [m]
  Mat3 inertia = Mat3::Zero();  // about the centre, in the body [kg m2]
};

// Of all bodies, ground first.
std::vector<MassProperties> MassesOf(const MultibodyModel& model) {
  std::vector<MassProperties> masses;
  for (const SimTK::MobilizedBodyIndex index : model.simbody().bodies) {
    MassProperties of;
    if (index != SimTK::GroundIndex) {
      const SimTK::MassProperties& body =
          model.simbody().matter.getMobilizedBody(index).getBody().getDefaultRigidBodyMassProperties();
      of.mass = body.getMass();
      of.centre = FromSimbody(body.getMassCenter());
      if (of.mass > 0) of.inertia = FromSimbody(body.calcCentralInertia().toMat33());
    }
    masses.push_back(of);
  }
  return masses;
}

std::vector<int> AllBodies(const MultibodyModel& model) {
  std::vector<int> bodies(model.body_names().size());
  std::iota(bodies.begin(), bodies.end(), 0);
  return bodies;
}

Status CheckMass(const MultibodyModel& model) {
  if (model.total_mass_kg() > 0) return {};
  return Fail("the bodies of model '{}' have no mass: what the ground must carry is not known", model.name());
}

}  // namespace

Result<std::vector<WholeBodyLoad>> WholeBodyLoads(const MultibodyModel& model, const Vec3& gravity,
                                                  const std::vector<double>& times,
                                                  const CoordinateTrajectory& motion) {
  SINEW_TRY(CheckMass(model));
  const std::vector<MassProperties> masses = MassesOf(model);
  SINEW_ASSIGN(const auto motions, model.BodyMotions(times, motion, AllBodies(model)));
  std::vector<WholeBodyLoad> loads;
  loads.reserve(times.size());
  for (const std::vector<BodyMotion>& at_instant : motions) {
    WholeBodyLoad load;
    for (std::size_t b = 0; b < masses.size(); ++b) {
      const MassProperties& of = masses[b];
      if (!(of.mass > 0)) continue;
      const BodyMotion& body = at_instant[b];
      const Vec3 arm = body.rotation * of.centre;
      const Vec3& spin = body.angular_velocity;
      const Vec3 acceleration =
          body.acceleration + body.angular_acceleration.cross(arm) + spin.cross(spin.cross(arm));
      const Vec3 centre = body.position + arm;
      const Vec3 force = of.mass * (acceleration - gravity);
      const Mat3 inertia = body.rotation * of.inertia * body.rotation.transpose();
      load.force += force;
      load.moment +=
          centre.cross(force) + inertia * body.angular_acceleration + spin.cross(Vec3(inertia * spin));
      load.mass_centre += of.mass / model.total_mass_kg() * centre;
    }
    loads.push_back(load);
  }
  return loads;
}

Result<double> MassMovedBy(const MultibodyModel& model, const std::string& coordinate) {
  SINEW_TRY(CheckMass(model));
  SINEW_ASSIGN(const int index, model.CoordinateIndex(coordinate));
  constexpr double kStill = 1e-9;  // [m/s, rad/s] of a unit rate
  Vector rates = Vector::Zero(model.default_values().size());
  rates[index] = 1;
  SINEW_ASSIGN(const auto motions, model.BodyMotionAt(model.default_values(), rates, AllBodies(model)));
  const std::vector<MassProperties> masses = MassesOf(model);
  double moved = 0;
  for (std::size_t b = 0; b < masses.size(); ++b) {
    if (motions[b].velocity.norm() > kStill || motions[b].angular_velocity.norm() > kStill)
      moved += masses[b].mass;
  }
  return moved / model.total_mass_kg();
}

}  // namespace sinew
