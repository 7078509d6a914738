#include "models/contact/simbody_contact.h"

#include <Simbody.h>

#include <exception>

#include "base/assert.h"
#include "base/text.h"
#include "models/multibody/simbody_model.h"

namespace sinew {
namespace {

SimTK::Rotation RotationOf(const Mat3& m) {
  return SimTK::Rotation(
      SimTK::Mat33(m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), m(2, 0), m(2, 1), m(2, 2)));
}

SimTK::ContactGeometry::TriangleMesh MeshOf(const ContactMesh& mesh) {
  SimTK::Array_<SimTK::Vec3> vertices;
  SimTK::Array_<int> corners;
  for (const Vec3& vertex : mesh.vertices) vertices.push_back(ToSimbody(vertex));
  for (const auto& face : mesh.faces) corners.insert(corners.end(), face.begin(), face.end());
  return {vertices, corners};
}

}  // namespace

struct SimbodyContact::Simulation {
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter{system};
  SimTK::GeneralForceSubsystem forces{system};
  SimTK::GeneralContactSubsystem contacts{system};
  std::vector<SimTK::MobilizedBody::Free> bodies;
  SimTK::State state;
  double floor_height = 0;
};

SimbodyContact::SimbodyContact(const std::vector<ContactRegion>& regions,
                               const std::vector<ElasticFoundation>& parameters, double transition_velocity,
                               double floor_height)
    : simulation_(std::make_unique<Simulation>()) {
  SINEW_ASSERT(regions.size() == parameters.size(), "one set of parameters per region");
  Simulation& s = *simulation_;
  s.floor_height = floor_height;
  const SimTK::ContactSetIndex set = s.contacts.createContactSet();
  // Simbody's half-space fills x > 0 of its frame: turned so that it fills y < floor height.
  s.contacts.addBody(
      set, s.matter.Ground(), SimTK::ContactGeometry::HalfSpace(),
      SimTK::Transform(SimTK::Rotation(-0.5 * SimTK::Pi, SimTK::ZAxis), SimTK::Vec3(0, floor_height, 0)));
  SimTK::ElasticFoundationForce foundation(s.forces, s.contacts, set);
  foundation.setTransitionVelocity(transition_velocity);
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const SimTK::Body::Rigid any_body(SimTK::MassProperties(1, SimTK::Vec3(0), SimTK::Inertia(1)));
    s.bodies.emplace_back(s.matter.Ground(), SimTK::Transform(), any_body, SimTK::Transform());
    s.contacts.addBody(set, s.bodies.back(), MeshOf(regions[i].mesh),
                       SimTK::Transform(RotationOf(regions[i].rotation), ToSimbody(regions[i].position)));
    const ElasticFoundation& p = parameters[i];
    foundation.setBodyParameters(SimTK::ContactSurfaceIndex(static_cast<int>(i) + 1), p.stiffness,
                                 p.dissipation, p.static_friction, p.dynamic_friction, p.viscous_friction);
  }
  s.state = s.system.realizeTopology();
  s.system.realizeModel(s.state);
}

SimbodyContact::~SimbodyContact() = default;
SimbodyContact::SimbodyContact(SimbodyContact&&) noexcept = default;
SimbodyContact& SimbodyContact::operator=(SimbodyContact&&) noexcept = default;

Result<std::vector<ContactWrench>> SimbodyContact::WrenchesAt(const std::vector<BodyMotion>& motion) {
  Simulation& s = *simulation_;
  SINEW_ASSERT(motion.size() == s.bodies.size(), "one motion per region");
  try {
    for (std::size_t i = 0; i < motion.size(); ++i) {
      s.bodies[i].setQToFitTransform(
          s.state, SimTK::Transform(RotationOf(motion[i].rotation), ToSimbody(motion[i].position)));
    }
    s.system.realize(s.state, SimTK::Stage::Position);
    for (std::size_t i = 0; i < motion.size(); ++i) {
      s.bodies[i].setUToFitVelocity(
          s.state, SimTK::SpatialVec(ToSimbody(motion[i].angular_velocity), ToSimbody(motion[i].velocity)));
    }
    s.system.realize(s.state, SimTK::Stage::Dynamics);
    const auto& loads = s.system.getRigidBodyForces(s.state, SimTK::Stage::Dynamics);
    std::vector<ContactWrench> wrenches;
    for (std::size_t i = 0; i < motion.size(); ++i) {
      const SimTK::SpatialVec& load =
          loads[s.bodies[i].getMobilizedBodyIndex()];  // moment about the body's origin
      const Vec3 force = FromSimbody(load[1]);
      const Vec3 arm = motion[i].position - Vec3(0, s.floor_height, 0);
      wrenches.push_back({force, FromSimbody(load[0]) + Vec3(arm.y() * force.z() - arm.z() * force.y(),
                                                             arm.z() * force.x() - arm.x() * force.z(),
                                                             arm.x() * force.y() - arm.y() * force.x())});
    }
    return wrenches;
  } catch (const std::exception& exception) {
    return Fail("Simbody could not compute the contact force: {}", OneLine(exception.what()));
  }
}

}  // namespace sinew
