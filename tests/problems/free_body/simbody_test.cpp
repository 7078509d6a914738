// The same toss as a Simbody model: spheres on a half space by SimTK::HuntCrossleyForce, another formulation
// of the motion, another integrator.
#include <Simbody.h>
#include <gtest/gtest.h>

#include <cmath>

#include "problems/free_body/window.h"

namespace sinew {
namespace {

constexpr double kMass = 0.4;
constexpr double kEdge = 0.1;
constexpr double kRadius = 0.01;
constexpr double kStiff = 4e5;  // [N/m^1.5]
constexpr double kLoss = 0.8;   // [s/m]
constexpr double kStatic = 0.35;
constexpr double kDynamic = 0.25;
constexpr double kViscous = 0.1;
const Vec3 kInertia(7e-4, 8e-4, 9e-4);

FlightStart Thrown() {
  FlightStart start;
  start.pose = {0.01, -0.02, 0.13, 0.8, 0.4, 0.3, std::sqrt(1 - 0.64 - 0.16 - 0.09)};
  start.velocity << 0.7, 0.4, -0.1;
  start.spin << 3, -5, 2;
  return start;
}

std::vector<Pose> BySinew(const std::vector<double>& times) {
  FreeBody body;
  const Vec3 edges = Vec3::Constant(kEdge);
  body.points = PointsOfBox(edges, FreeBodyContact::kVertices, 1);
  body.mass = kMass;
  body.inertia = kInertia;
  body.size = kEdge / 2;
  body.reach = edges.norm() / 2;
  FreeBodyNumbers numbers;
  numbers.value[kStiffness] = kStiff;
  numbers.value[kDissipation] = kLoss;
  numbers.value[kFriction] = kDynamic;
  numbers.value[kStaticExcess] = kStatic - kDynamic;
  numbers.value[kViscousSlip] = kViscous;
  numbers.value[kCornerRadius] = kRadius;
  FlightLimits limits;
  limits.accuracy = 1e-10;
  limits.most_steps = 1000000;
  std::vector<Pose> poses(times.size());
  const Status status = Fly(body, numbers.value, numbers.Used(), Thrown(), -1, times, limits, poses.data());
  EXPECT_TRUE(status) << status.error().message;
  return poses;
}

std::vector<Pose> BySimbody(const std::vector<double>& times) {
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter(system);
  SimTK::GeneralForceSubsystem forces(system);
  SimTK::GeneralContactSubsystem contacts(system);
  SimTK::Force::Gravity gravity(forces, matter, SimTK::Vec3(0, 0, -9.81));
  const SimTK::Inertia inertia(kInertia.x(), kInertia.y(), kInertia.z());
  SimTK::MobilizedBody::Free cube(matter.Ground(), SimTK::Transform(),
                                  SimTK::Body::Rigid(SimTK::MassProperties(kMass, SimTK::Vec3(0), inertia)),
                                  SimTK::Transform());
  const SimTK::ContactSetIndex set = contacts.createContactSet();
  // A half space lies where its x is positive.
  const SimTK::Rotation down(SimTK::Pi / 2, SimTK::YAxis);
  contacts.addBody(set, matter.updGround(), SimTK::ContactGeometry::HalfSpace(), SimTK::Transform(down));
  const double reach = kEdge / 2 - kRadius;
  for (const double x : {-reach, reach}) {
    for (const double y : {-reach, reach}) {
      for (const double z : {-reach, reach})
        contacts.addBody(set, cube, SimTK::ContactGeometry::Sphere(kRadius),
                         SimTK::Transform(SimTK::Vec3(x, y, z)));
    }
  }
  // k = 4/3 sqrt(R) E of the table alone, since the spheres are as good as rigid: so the force acts where
  // their surface would be.
  const double modulus = kStiff * 3 / 4 / std::sqrt(kRadius);
  SimTK::HuntCrossleyForce contact(forces, contacts, set);
  for (SimTK::ContactSurfaceIndex i(0); i < 9; ++i) {
    contact.setBodyParameters(i, i == 0 ? modulus : 1e12 * modulus, kLoss, kStatic, kDynamic, kViscous);
  }
  contact.setTransitionVelocity(0.01);
  SimTK::State state = system.realizeTopology();
  const FlightStart start = Thrown();
  const auto& p = start.pose;
  const SimTK::Rotation turn(SimTK::Quaternion(SimTK::Vec4(p[3], p[4], p[5], p[6])));
  cube.setQToFitTransform(state, SimTK::Transform(turn, SimTK::Vec3(p[0], p[1], p[2])));
  const auto& v = start.velocity;
  const auto& w = start.spin;
  cube.setUToFitVelocity(
      state, SimTK::SpatialVec(turn * SimTK::Vec3(w[0], w[1], w[2]), SimTK::Vec3(v[0], v[1], v[2])));
  SimTK::RungeKuttaMersonIntegrator integrator(system);
  integrator.setAccuracy(1e-9);
  integrator.setMaximumStepSize(1e-4);
  SimTK::TimeStepper stepper(system, integrator);
  stepper.initialize(state);
  std::vector<Pose> poses;
  for (const double t : times) {
    stepper.stepTo(t);
    const SimTK::Transform& at = cube.getBodyTransform(stepper.getState());
    const SimTK::Vec4 q = at.R().convertRotationToQuaternion().asVec4();
    poses.push_back({at.p()[0], at.p()[1], at.p()[2], q[0], q[1], q[2], q[3]});
  }
  return poses;
}

// Over touches of several corners, and sliding: an error grows tenfold at every touch.
TEST(FreeBodySimbodyTest, TheSameToss) {
  std::vector<double> times;
  for (int i = 0; i <= 30; ++i) times.push_back(0.01 * i);
  const auto ours = BySinew(times);
  const auto theirs = BySimbody(times);
  double lowest = 1;
  for (std::size_t i = 0; i < times.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(ours[i][c], theirs[i][c], 1e-7) << times[i] << " " << c;
    EXPECT_NEAR(AngleBetween(ours[i], theirs[i]), 0, 1e-5) << times[i];
    lowest = std::min(lowest, ours[i][2]);
  }
  EXPECT_LT(lowest, 0.08) << "it has touched and tumbles";
}

}  // namespace
}  // namespace sinew
