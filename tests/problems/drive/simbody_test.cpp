// The same joint as a Simbody model: another formulation, another integrator.
#include <Simbody.h>
#include <gtest/gtest.h>

#include "tests/problems/support/drive_bench.h"

namespace sinew {
namespace {

constexpr double kMass = 0.9;
constexpr double kLength = 0.25;
constexpr double kArmature = 0.02;
constexpr double kViscous = 0.08;
constexpr double kRate = 100;

double Command(double t) {
  return 0.8 * std::sin(3 * t) + 0.4 * std::sin(7.3 * t + 1);
}

// Straight between samples, as the drive problem takes it.
double Sampled(double t) {
  const double first = std::floor(t * kRate) / kRate;
  const double part = (t - first) * kRate;
  return (1 - part) * Command(first) + part * Command(first + 1 / kRate);
}

class Torque final : public SimTK::Force::Custom::Implementation {
 public:
  Torque(const SimTK::MobilizedBody& body, double friction) : body_(body), friction_(friction) {}
  void calcForce(const SimTK::State& state, SimTK::Vector_<SimTK::SpatialVec>& /*bodies*/,
                 SimTK::Vector_<SimTK::Vec3>& /*particles*/, SimTK::Vector& mobilities) const override {
    const double v = body_.getOneU(state, 0);
    const double sign = v > 0 ? 1 : v < 0 ? -1 : 0;
    body_.applyOneMobilityForce(state, 0, Sampled(state.getTime()) - friction_ * sign, mobilities);
  }
  SimTK::Real calcPotentialEnergy(const SimTK::State& /*state*/) const override { return 0; }

 private:
  const SimTK::MobilizedBody& body_;
  double friction_;
};

// Positions at k / rate.
std::vector<double> Simulate(double q, double v, double friction, int samples) {
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter(system);
  SimTK::GeneralForceSubsystem forces(system);
  SimTK::Force::Gravity gravity(forces, matter, SimTK::Vec3(0, -9.80665, 0));
  const SimTK::Vec3 centre(0, -kLength, 0);
  // The inertia across the axis does not matter for a pin; it only has to be possible.
  const SimTK::Inertia inertia(kMass * kLength * kLength + kArmature, kArmature,
                               kMass * kLength * kLength + kArmature);
  SimTK::MobilizedBody::Pin pin(matter.Ground(), SimTK::Transform(),
                                SimTK::Body::Rigid(SimTK::MassProperties(kMass, centre, inertia)),
                                SimTK::Transform());
  SimTK::Force::MobilityLinearDamper damper(forces, pin, 0, kViscous);
  SimTK::Force::Custom torque(forces, new Torque(pin, friction));  // Simbody deletes it
  SimTK::State state = system.realizeTopology();
  pin.setOneQ(state, 0, q);
  pin.setOneU(state, 0, v);
  SimTK::RungeKuttaMersonIntegrator integrator(system);
  integrator.setAccuracy(1e-11);
  integrator.setMaximumStepSize(1e-3);
  SimTK::TimeStepper stepper(system, integrator);
  stepper.initialize(state);
  std::vector<double> positions;
  for (int i = 0; i < samples; ++i) {
    stepper.stepTo(i / kRate);
    positions.push_back(pin.getOneQ(stepper.getState(), 0));
  }
  return positions;
}

Vector Predict(double q, double v, double friction, bool known_load) {
  Bench bench;
  bench.command = Command;
  bench.step = 0.001;
  if (known_load) bench.constants = {{"load_mass", kMass}, {"load_length", kLength}};
  const auto problem = BindBench(bench);
  std::map<std::string, double> values{{"inertia", kArmature + (known_load ? 0 : kMass * kLength * kLength)},
                                       {"viscous_friction", kViscous},
                                       {"coulomb_torque", friction},
                                       {"initial_position@swing", q},
                                       {"initial_speed@swing", v}};
  if (known_load) {
    values["drive_gain"] = 1;
  } else {
    values["gravity_torque"] = kMass * 9.80665 * kLength;
  }
  return PredictDrive(*problem, DrivePoint(*problem, values)).Values("position");
}

TEST(DriveSimbody, SmoothMotionIsTheSame) {
  const auto expected = Simulate(0.5, -0.3, 0, 401);
  for (const bool known_load : {false, true}) {
    const Vector found = Predict(0.5, -0.3, 0, known_load);
    for (int i = 0; i < 401; ++i) {
      // Errors of both integrators at these steps, over 4 s.
      ASSERT_NEAR(found[i], expected[static_cast<std::size_t>(i)], 1e-8) << "sample " << i;
    }
  }
}

TEST(DriveSimbody, SlidingUnderCoulombFrictionIsTheSame) {
  // Up to the first reversal, where Simbody's force would jump within a step.
  const auto expected = Simulate(-0.9, 1.5, 0.2, 60);
  const Vector found = Predict(-0.9, 1.5, 0.2, false);
  int compared = 0;
  for (int i = 1; i < 60 && expected[static_cast<std::size_t>(i)] > expected[static_cast<std::size_t>(i - 1)];
       ++i) {
    ASSERT_NEAR(found[i], expected[static_cast<std::size_t>(i)], 1e-8) << "sample " << i;
    ++compared;
  }
  EXPECT_GT(compared, 20);
}

}  // namespace
}  // namespace sinew
