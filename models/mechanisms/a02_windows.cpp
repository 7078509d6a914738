// A02: N four-bar windows in a row: N + 1 links stand on the ground, N links lie across their tops; all are
// uniform slender rods of 1 kg and 1 m. Tables 1 and 2 of the thesis. Whenever the links lie flat, every
// window could fold in one of two ways: the mechanism has one degree of freedom, at that instant N + 1.
#include "models/mechanisms/mechanism_system.h"

namespace sinew {
namespace {

using SimTK::Vec3;

/// Bodies that turn alike and bodies that only translate are one body: with parallel windows, N + 1 pendulums
/// are one of N + 1 times the inertia, and N links that stay level are a point mass at its tip.
SimTK::MassProperties Merged(int windows) {
  const Vec3 tip(0, 1, 0);
  const SimTK::MassProperties rod = SlenderRod(windows + 1, tip);
  const double mass = 2.0 * windows + 1;
  return {mass, ((windows + 1) * rod.getMassCenter() + windows * tip) / mass,
          rod.getInertia() + SimTK::Inertia(tip, windows)};
}

/// q of a = sign times q of b.
void Couple(SimTK::SimbodyMatterSubsystem& matter, const SimTK::MobilizedBody& a,
            const SimTK::MobilizedBody& b, double sign) {
  SimTK::Array_<SimTK::MobilizedBodyIndex> bodies;
  bodies.push_back(a.getMobilizedBodyIndex());
  bodies.push_back(b.getMobilizedBodyIndex());
  const SimTK::Array_<SimTK::MobilizerQIndex> coordinates(2, SimTK::MobilizerQIndex(0));
  SimTK::Vector factors(3, 0.0);
  factors[0] = 1;
  factors[1] = -sign;
  SimTK::Constraint::CoordinateCoupler(matter, new SimTK::Function::Linear(factors), bodies, coordinates);
}

}  // namespace

std::unique_ptr<MechanismSystem> BuildWindows(int windows, const std::string& formulation) {
  using SimTK::Vec3;
  auto m = std::make_unique<MechanismSystem>();
  SimTK::Force::UniformGravity(m->forces, m->matter, Vec3(0, -9.81, 0));
  const Vec3 up(0, 1, 0);
  const Vec3 across(1, 0, 0);
  const SimTK::Body::Rigid standing(SlenderRod(1, up));
  const SimTK::Body::Rigid lying(SlenderRod(1, across));
  std::vector<SimTK::MobilizedBody> verticals;
  std::vector<SimTK::MobilizedBody> levels;
  if (formulation == "merged") {
    verticals.push_back(SimTK::MobilizedBody::Pin(m->matter.Ground(), SimTK::Transform(),
                                                  SimTK::Body::Rigid(Merged(windows)), SimTK::Transform()));
  } else {
    for (int i = 0; i <= windows; ++i)
      verticals.push_back(
          SimTK::MobilizedBody::Pin(m->matter.Ground(), Vec3(i, 0, 0), standing, SimTK::Transform()));
    for (std::size_t i = 0; i + 1 < verticals.size(); ++i) {
      levels.push_back(SimTK::MobilizedBody::Pin(verticals[i], up, lying, SimTK::Transform()));
      if (formulation == "couplers") {
        Couple(m->matter, verticals[i + 1], verticals[i], 1);
        Couple(m->matter, levels[i], verticals[i], -1);
      } else {
        // The end of the level link at the top of the next standing one.
        SimTK::Constraint::PointInPlane(verticals[i + 1], SimTK::UnitVec3(1, 0, 0), 0, levels[i], across);
        SimTK::Constraint::PointInPlane(verticals[i + 1], SimTK::UnitVec3(0, 1, 0), 1, levels[i], across);
      }
    }
  }
  m->state = m->system.realizeTopology();
  // The tops move at 1 m/s in x.
  for (const auto& body : verticals) body.setOneU(m->state, 0, -1);
  for (const auto& body : levels) body.setOneU(m->state, 0, 1);
  const SimTK::MobilizedBody first = verticals.front();
  m->coordinates = [first, up](const SimTK::State& state) {
    const Vec3 at = first.findStationLocationInGround(state, up);
    return Vector(Eigen::Vector2d(at[0], at[1]));
  };
  return m;
}

}  // namespace sinew
