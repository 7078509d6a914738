// A03: Andrews' squeezer, seven bodies in a plane that a motor and a spring drive. Numbers: tables 3 to 6 of
// the thesis and, with more of the geometry and its names, Hairer & Wanner, Solving Ordinary Differential
// Equations II (1996), VI.9; they agree but for the sign of B's x, which the thesis lacks.
#include "models/mechanisms/mechanism_system.h"

namespace sinew {
namespace {

using SimTK::Vec3;

// Points in the ground [m].
const Vec3 kA(-0.06934, -0.00227, 0);
const Vec3 kB(-0.03635, 0.03273, 0);
const Vec3 kC(0.014, 0.072, 0);
// Points in the bodies [m].
const Vec3 kFOfCrank(0.007, 0, 0);
const Vec3 kEOfRod(-0.028, 0, 0);
const Vec3 kEOfTriangle(0, -0.035, 0);
const Vec3 kDOfTriangle(0.02, -0.018, 0);
const Vec3 kGOfArm(0.04, 0, 0);
const Vec3 kEOfLink(0, -0.02, 0);
const Vec3 kHOfArm(0, -0.04, 0);
const Vec3 kEOfOtherLink(0.02, 0, 0);

constexpr double kSpring = 4530;         // [N/m]
constexpr double kRestLength = 0.07785;  // [m]
constexpr double kMotor = 0.033;         // [N m]

// beta, Theta, gamma, Phi, delta, Omega, epsilon of the IVP test set.
constexpr double kStart[] = {-0.0617138900142764496, 0.0,
                             0.4552798191630703803,  0.2226683901658858847,
                             0.4873649795438425502,  -0.2226683901658858847,
                             1.2305474445498211925};
constexpr double kCrankOfThesis = -0.0620;

/// In the plane; the inertia is about the centre of mass.
SimTK::Body::Rigid Flat(double mass, const Vec3& centre, double inertia) {
  return SimTK::Body::Rigid(SimTK::MassProperties(
      mass, centre, SimTK::Inertia(inertia, inertia, inertia).shiftFromMassCenter(centre, mass)));
}

/// Where two bodies share the point E. In the plane only: the third direction holds by itself.
void Close(SimTK::MobilizedBody& rod, SimTK::MobilizedBody& other, const Vec3& point) {
  SimTK::Constraint::PointInPlane(rod, SimTK::UnitVec3(1, 0, 0), kEOfRod[0], other, point);
  SimTK::Constraint::PointInPlane(rod, SimTK::UnitVec3(0, 1, 0), kEOfRod[1], other, point);
}

}  // namespace

std::unique_ptr<MechanismSystem> BuildAndrews(bool ivp_start) {
  using SimTK::MobilizedBody;
  using SimTK::Vec3;
  const SimTK::Transform origin;
  auto m = std::make_unique<MechanismSystem>();
  MobilizedBody& ground = m->matter.Ground();
  MobilizedBody::Pin crank(ground, origin, Flat(0.04325, Vec3(0.00092, 0, 0), 2.194e-6), origin);
  MobilizedBody::Pin rod(crank, kFOfCrank, Flat(0.00365, Vec3(-0.0115, 0, 0), 4.41e-7), origin);
  MobilizedBody::Pin triangle(ground, kB, Flat(0.02373, Vec3(0.01043, -0.01874, 0), 5.255e-6), origin);
  MobilizedBody::Pin arm(ground, kA, Flat(0.0705, Vec3(0.02308, 0.00916, 0), 1.169e-5), origin);
  MobilizedBody::Pin link(arm, kGOfArm, Flat(0.00706, Vec3(0, -0.00579, 0), 5.667e-7), origin);
  MobilizedBody::Pin other_arm(ground, kA, Flat(0.05498, Vec3(-0.00449, -0.01228, 0), 1.912e-5), origin);
  MobilizedBody::Pin other_link(other_arm, kHOfArm, Flat(0.00706, Vec3(0.00579, 0, 0), 5.667e-7), origin);
  SimTK::Force::TwoPointLinearSpring(m->forces, ground, kC, triangle, kDOfTriangle, kSpring, kRestLength);
  SimTK::Force::MobilityConstantForce(m->forces, crank, SimTK::MobilizerUIndex(0), kMotor);
  Close(rod, triangle, kEOfTriangle);
  Close(rod, link, kEOfLink);
  Close(rod, other_link, kEOfOtherLink);

  m->state = m->system.realizeTopology();
  const std::vector<MobilizedBody> in_order{crank, rod, triangle, link, arm, other_link, other_arm};
  for (std::size_t i = 0; i < in_order.size(); ++i) in_order[i].setOneQ(m->state, 0, kStart[i]);
  if (!ivp_start) {
    crank.setAngle(m->state, kCrankOfThesis);
    SimTK::Assembler assembler(m->system);
    assembler.lockMobilizer(crank.getMobilizedBodyIndex());
    assembler.setAccuracy(1e-13);
    assembler.assemble(m->state);
  }
  const double start = crank.getAngle(m->state);
  m->work = [crank, start](const SimTK::State& state) { return kMotor * (crank.getAngle(state) - start); };
  if (ivp_start) {
    m->coordinates = [in_order](const SimTK::State& state) {
      Vector angles(static_cast<Eigen::Index>(in_order.size()));
      for (std::size_t i = 0; i < in_order.size(); ++i)
        angles[static_cast<Eigen::Index>(i)] = in_order[i].getOneQ(state, 0);
      return angles;
    };
  } else {
    m->coordinates = [crank](const SimTK::State& state) {
      const Vec3 at = crank.findStationLocationInGround(state, kFOfCrank);
      return Vector(Eigen::Vector2d(at[0], at[1]));
    };
  }
  return m;
}

}  // namespace sinew
