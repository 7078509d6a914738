// Foot and plate as two bodies of Simbody: forces act on points of bodies in space, another formulation of
// the mechanism, another integrator.
#include <Simbody.h>
#include <gtest/gtest.h>

#include "models/dynamometer/strapped_foot_run.h"

namespace sinew {
namespace {

constexpr double kAmplitude = 0.35;  // [rad] of the plate
constexpr double kRate = 4;          // [rad/s]
constexpr double kEnd = 1.6;         // [s]
constexpr double kApart = 0.01;      // [s] of what is compared
constexpr double kTilt = 0.3;        // [rad] of the shank

// What muscles do: +-30 N m, so that the foot lifts off and pulls at the straps.
double Activation(double t) {
  return 0.5 * std::sin(5 * t);
}
constexpr double kAntagonist = 60;

PlateMotion PlateAt(double t) {
  return {kAmplitude * std::cos(kRate * t), -kAmplitude * kRate * std::sin(kRate * t),
          -kAmplitude * kRate * kRate * std::cos(kRate * t)};
}

FootGeometry Geometry() {
  FootGeometry foot;
  foot.straps = DefaultStraps();
  foot.shank_tilt = kTilt;
  return foot;
}

StrappedFoot<double> Person() {
  StrappedFoot<double> foot;
  foot.antagonist = kAntagonist;
  foot.boundary.sole_stiffness = 5e6;
  foot.boundary.friction = 0.2;
  foot.boundary.axis_x = 0.012;
  foot.boundary.axis_y = -0.009;
  foot.attachment.inertia = 0.07;
  foot.attachment.gravity = 0;
  foot.attachment.viscous_friction = 0;
  return foot;
}

class FootForces final : public SimTK::Force::Custom::Implementation {
 public:
  FootForces(const SimTK::MobilizedBody& foot, const SimTK::MobilizedBody& plate)
      : foot_(foot), plate_(plate), geometry_(Geometry()), person_(Person()) {}

  void calcForce(const SimTK::State& state, SimTK::Vector_<SimTK::SpatialVec>& bodies,
                 SimTK::Vector_<SimTK::Vec3>& /*particles*/, SimTK::Vector& mobilities) const override {
    const BoundaryLaw<double>& law = person_.boundary;
    const double surface = law.sole_compression - geometry_.ankle_height - law.axis_y;
    const auto apply = [&](const SimTK::Vec3& on_foot, const SimTK::Vec3& on_plate,
                           const SimTK::Vec3& force) {
      foot_.applyForceToBodyPoint(state, on_foot, force, bodies);
      plate_.applyForceToBodyPoint(state, on_plate, -force, bodies);
    };
    const double strip = (geometry_.heel + geometry_.toe) / geometry_.strips;
    for (int i = 0; i < geometry_.strips; ++i) {
      const SimTK::Vec3 sole(-geometry_.heel + (i + 0.5) * strip, -geometry_.ankle_height, 0);
      const SimTK::Vec3 below =
          plate_.findStationAtGroundPoint(state, foot_.findStationLocationInGround(state, sole));
      const double depth = surface - below[1];
      if (depth <= 0) continue;
      const SimTK::Vec3 moving =
          plate_.expressGroundVectorInBodyFrame(state, foot_.findStationVelocityInGround(state, sole) -
                                                           plate_.findStationVelocityInGround(state, below));
      const double elastic = law.sole_stiffness * strip * geometry_.width * depth;
      const double normal = std::max(0.0, elastic * (1 - law.sole_dissipation * moving[1]));
      const double slip = std::clamp(moving[0] / geometry_.transition_velocity, -1.0, 1.0);
      apply(sole, below,
            plate_.expressVectorInGroundFrame(state, SimTK::Vec3(-normal * law.friction * slip, normal, 0)));
    }
    for (const FootStrap& strap : geometry_.straps) {
      const SimTK::Vec3 top(strap.foot_x, strap.foot_y, 0);
      const SimTK::Vec3 bottom(strap.plate_x - law.axis_x, surface, 0);
      const SimTK::Vec3 way =
          plate_.findStationLocationInGround(state, bottom) - foot_.findStationLocationInGround(state, top);
      const double rest = std::hypot(strap.plate_x - strap.foot_x, geometry_.ankle_height + strap.foot_y) -
                          law.sole_compression;
      const double force = law.strap_pretension + law.strap_stiffness / law.strap_exponent *
                                                      std::expm1(law.strap_exponent * (way.norm() - rest));
      if (force <= 0) continue;
      const SimTK::Vec3 along = way / way.norm();
      const double rate = SimTK::dot(along, plate_.findStationVelocityInGround(state, bottom) -
                                                foot_.findStationVelocityInGround(state, top));
      apply(top, bottom, std::max(0.0, force * (1 + law.strap_damping * rate)) * along);
    }
    const double angle = foot_.getOneQ(state, 0);
    const double passive = person_.passive.Moment(angle, foot_.getOneU(state, 0));
    foot_.applyOneMobilityForce(state, 0, passive - kAntagonist * Activation(state.getTime()), mobilities);
  }
  SimTK::Real calcPotentialEnergy(const SimTK::State& /*state*/) const override { return 0; }

 private:
  const SimTK::MobilizedBody& foot_;
  const SimTK::MobilizedBody& plate_;
  FootGeometry geometry_;
  StrappedFoot<double> person_;
};

struct Trajectory {
  std::vector<double> angle;     // of the ankle [rad]
  std::vector<double> velocity;  // [rad/s]
  std::vector<double> torque;    // of foot and attachment on the motor [N m]
};

Trajectory InSimbody(double begin) {
  const FootGeometry geometry = Geometry();
  const StrappedFoot<double> person = Person();
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter(system);
  SimTK::GeneralForceSubsystem forces(system);
  SimTK::Force::Gravity gravity(forces, matter,
                                geometry.gravity * SimTK::Vec3(std::sin(kTilt), -std::cos(kTilt), 0));
  const SimTK::Vec3 centre(geometry.mass_x, geometry.mass_y, 0);
  // Across the axis it does not matter for a pin; it only has to be possible.
  const SimTK::Inertia central(geometry.inertia - geometry.mass * centre.normSqr());
  SimTK::MobilizedBody::Pin foot(
      matter.Ground(), SimTK::Transform(),
      SimTK::Body::Rigid(
          SimTK::MassProperties(geometry.mass, centre, central.shiftFromMassCenter(centre, geometry.mass))),
      SimTK::Transform());
  SimTK::MobilizedBody::Pin plate(
      matter.Ground(), SimTK::Transform(SimTK::Vec3(person.boundary.axis_x, person.boundary.axis_y, 0)),
      SimTK::Body::Rigid(SimTK::MassProperties(1, SimTK::Vec3(0), SimTK::Inertia(person.attachment.inertia))),
      SimTK::Transform());
  SimTK::Motion::Sinusoid motion(plate, SimTK::Motion::Position, kAmplitude, kRate, std::acos(-1) / 2);
  SimTK::Force::Custom contact(forces, new FootForces(foot, plate));  // Simbody deletes it
  SimTK::State state = system.realizeTopology();
  foot.setOneQ(state, 0, begin);
  SimTK::RungeKuttaMersonIntegrator integrator(system);
  integrator.setAccuracy(1e-10);
  integrator.setMaximumStepSize(1e-3);
  SimTK::TimeStepper stepper(system, integrator);
  stepper.initialize(state);
  Trajectory found;
  for (int i = 0; i <= std::lround(kEnd / kApart); ++i) {
    stepper.stepTo(i * kApart);
    const SimTK::State& now = stepper.getState();
    system.realize(now, SimTK::Stage::Acceleration);
    found.angle.push_back(foot.getOneQ(now, 0));
    found.velocity.push_back(foot.getOneU(now, 0));
    SimTK::Vector motor;
    matter.findMotionForces(now, motor);
    found.torque.push_back(motor[plate.getFirstUIndex(now)]);
  }
  return found;
}

Trajectory InOurs(double step) {
  const FootGeometry geometry = Geometry();
  const StrappedFoot<double> person = Person();
  const MuscleCurves curves = MuscleCurves::Default();
  const std::vector<MusclePath> none;
  FootSolutions solutions;
  StrappedFootRun<double> run(geometry, curves, none, person, solutions);
  EXPECT_TRUE(run.Settle(0, PlateAt(0), {Activation(0)}));
  Trajectory found;
  const auto see = [&](double t) {
    found.angle.push_back(run.instant().ankle_angle);
    found.velocity.push_back(run.instant().ankle_velocity);
    found.torque.push_back(run.MachineTorque(PlateAt(t)));
  };
  see(0);
  const auto every = std::lround(kApart / step);
  for (long i = 0; i < std::lround(kEnd / step); ++i) {
    PlateMotion plate[ImplicitStep::kStages];
    std::vector<double> activation[ImplicitStep::kStages];
    for (std::size_t k = 0; k < ImplicitStep::kStages; ++k) {
      const double t = step * (static_cast<double>(i) + ImplicitStep::kNodes[k]);
      plate[k] = PlateAt(t);
      activation[k] = {Activation(t)};
    }
    EXPECT_TRUE(run.Step(step, plate, activation));
    if ((i + 1) % every == 0) see(step * static_cast<double>(i + 1));
  }
  return found;
}

double Largest(const std::vector<double>& a, const std::vector<double>& b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

TEST(StrappedFootSimbody, TheTrajectoryIsTheSame) {
  const Trajectory ours = InOurs(0.00025);
  const Trajectory theirs = InSimbody(ours.angle.front());
  const auto [least, most] = std::minmax_element(ours.torque.begin(), ours.torque.end());
  ASSERT_GT(*most - *least, 40);
  double between = 0;
  for (std::size_t i = 0; i < ours.angle.size(); ++i)
    between = std::max(between, std::abs(ours.angle[i] - PlateAt(kApart * static_cast<double>(i)).angle));
  ASSERT_GT(between, 0.02);
  EXPECT_LT(Largest(ours.angle, theirs.angle), 1e-6);
  EXPECT_LT(Largest(ours.velocity, theirs.velocity), 1e-3);
  EXPECT_LT(Largest(ours.torque, theirs.torque), 1e-2);
}

}  // namespace
}  // namespace sinew
