// A01: a point mass of 1 kg on a massless bar of 1 m, from rest at x = -1. Figure 9 of the thesis.
#include "models/mechanisms/mechanism_system.h"

namespace sinew {

std::unique_ptr<MechanismSystem> BuildPendulum() {
  using SimTK::Vec3;
  auto m = std::make_unique<MechanismSystem>();
  SimTK::Force::UniformGravity(m->forces, m->matter, Vec3(0, -9.81, 0));
  const Vec3 tip(1, 0, 0);
  const SimTK::Body::Rigid mass(SimTK::MassProperties(1, tip, SimTK::Inertia(tip, 1)));
  SimTK::MobilizedBody::Pin bar(m->matter.Ground(), SimTK::Transform(), mass, SimTK::Transform());
  m->state = m->system.realizeTopology();
  bar.setOneQ(m->state, 0, SimTK::Pi);
  m->coordinates = [bar, tip](const SimTK::State& state) {
    const Vec3 at = bar.findStationLocationInGround(state, tip);
    return Vector(Eigen::Vector2d(at[0], at[1]));
  };
  return m;
}

}  // namespace sinew
