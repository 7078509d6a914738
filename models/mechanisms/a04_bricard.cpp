// A04: Bricard's mechanism. Five uniform slender rods of 1 kg and 1 m along the edges of a cube, hinged to
// each other and to the ground by six hinges, each across its two rods. Counted, it cannot move; since the
// hinges are where they are, it has one degree of freedom.
#include <array>

#include "models/mechanisms/mechanism_system.h"

namespace sinew {
namespace {

using SimTK::UnitVec3;
using SimTK::Vec3;

// The hinges at the start; the sixth rod, from the last to the first, is the ground.
const std::array<Vec3, 6> kHinges{Vec3(0, 0, 0),  Vec3(1, 0, 0),  Vec3(1, -1, 0),
                                  Vec3(1, -1, 1), Vec3(0, -1, 1), Vec3(0, 0, 1)};
const std::array<Vec3, 6> kAxes{Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, 0, 0),
                                Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, 0, 0)};

SimTK::Transform HingeFrame(std::size_t hinge, const Vec3& at) {
  return {SimTK::Rotation(UnitVec3(kAxes[hinge]), SimTK::ZAxis), at};
}

/// Rods from the ground on, one at the end of the other: from hinge `first` over the following (step 1) or
/// the preceding ones (step -1).
std::vector<SimTK::MobilizedBody> Chain(MechanismSystem& m, int first, int step, int rods) {
  std::vector<SimTK::MobilizedBody> chain;
  Vec3 at = kHinges[static_cast<std::size_t>(first)];  // of the hinge, in the body before
  for (int i = 0; i < rods; ++i) {
    const auto hinge = static_cast<std::size_t>(first + step * i);
    const auto next = static_cast<std::size_t>(first + step * (i + 1));
    const Vec3 along = kHinges[next] - kHinges[hinge];
    SimTK::MobilizedBody parent = m.matter.Ground();
    if (!chain.empty()) parent = chain.back();
    chain.push_back(SimTK::MobilizedBody::Pin(
        parent, HingeFrame(hinge, at), SimTK::Body::Rigid(SlenderRod(1, along)), HingeFrame(hinge, Vec3(0))));
    at = along;
  }
  return chain;
}

}  // namespace

std::unique_ptr<MechanismSystem> BuildBricard(const std::string& formulation) {
  using SimTK::Vec3;
  auto m = std::make_unique<MechanismSystem>();
  SimTK::Force::UniformGravity(m->forces, m->matter, Vec3(0, -9.81, 0));
  const bool middle = formulation == "middle";
  const int cut = middle ? 3 : 5;  // the hinge that is no joint but a constraint
  const std::vector<SimTK::MobilizedBody> chain = Chain(*m, 0, 1, cut);
  SimTK::MobilizedBody left = chain.back();
  SimTK::MobilizedBody right = m->matter.Ground();
  if (middle) right = Chain(*m, 5, -1, 5 - cut).back();
  const auto hinge = static_cast<std::size_t>(cut);
  SimTK::Constraint::Ball(left, kHinges[hinge] - kHinges[hinge - 1], right,
                          middle ? kHinges[hinge] - kHinges[hinge + 1] : kHinges[hinge]);
  const UnitVec3 axis(kAxes[hinge]);
  const UnitVec3 across = axis.perp();
  SimTK::Constraint::ConstantAngle(left, axis, right, across);
  SimTK::Constraint::ConstantAngle(left, axis, right, UnitVec3(axis % across));

  m->state = m->system.realizeTopology();
  const SimTK::MobilizedBody second = chain[1];
  m->coordinates = [second](const SimTK::State& state) {
    const Vec3 at = second.findStationLocationInGround(state, kHinges[2] - kHinges[1]);
    return Vector(Eigen::Vector3d(at[0], at[1], at[2]));
  };
  return m;
}

}  // namespace sinew
