#include "models/multibody/multibody_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <thread>

#include "tests/models/multibody/test_models.h"

namespace sinew {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kRounding = 1e-12;  // a handful of products of numbers of order one
constexpr double kUpper = 0.5;       // lengths of the pendulum's links [m]
constexpr double kLower = 0.4;

Vector PendulumVector(const MultibodyModel& model, double shoulder, double elbow) {
  Vector vector(2);
  vector[*model.CoordinateIndex("shoulder_angle")] = shoulder;
  vector[*model.CoordinateIndex("elbow_angle")] = elbow;
  return vector;
}

// Vector of a link of the pendulum that hangs down at angle zero, and its first and second derivatives.
struct Link {
  Vec3 position, velocity, acceleration;
};
Link HangingLink(double length, double angle, double rate, double acceleration) {
  const Vec3 outward(std::sin(angle), -std::cos(angle), 0);
  const Vec3 along(std::cos(angle), std::sin(angle), 0);
  return {length * outward, length * rate * along, length * (acceleration * along - rate * rate * outward)};
}

void ExpectNear(const Vec3& a, const Vec3& b, double tolerance, const std::string& what) {
  EXPECT_NEAR((a - b).norm(), 0, tolerance) << what << ": " << a.transpose() << " and " << b.transpose();
}

std::string OneJoint(const std::string& type, int coordinates) {
  std::string list;
  for (int i = 0; i < coordinates; ++i) list += "<Coordinate name=\"q" + std::to_string(i) + "\"/>";
  return "<OpenSimDocument Version=\"40000\"><Model name=\"one\"><BodySet><objects><Body "
         "name=\"b\"><mass>1</mass>"
         "<inertia>1 1 1 0 0 0</inertia></Body></objects></BodySet><JointSet><objects><" +
         type +
         " name=\"j\"><socket_parent_frame>p</socket_parent_frame><socket_child_frame>c</socket_child_frame>"
         "<coordinates>" +
         list +
         "</coordinates><frames><PhysicalOffsetFrame name=\"p\"><socket_parent>/ground</socket_parent>"
         "<translation>1 2 3</translation><orientation>0.2 -0.3 0.4</orientation></PhysicalOffsetFrame>"
         "<PhysicalOffsetFrame name=\"c\"><socket_parent>/bodyset/b</socket_parent>"
         "<translation>-0.1 0.2 0.3</translation><orientation>-0.5 0.1 "
         "0.6</orientation></PhysicalOffsetFrame>"
         "</frames></" +
         type + "></objects></JointSet></Model></OpenSimDocument>";
}

Eigen::Isometry3d Placed(const Vec3& translation, double x, double y, double z) {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  frame.translate(translation);
  frame.rotate(Eigen::AngleAxisd(x, Vec3::UnitX()));
  frame.rotate(Eigen::AngleAxisd(y, Vec3::UnitY()));
  frame.rotate(Eigen::AngleAxisd(z, Vec3::UnitZ()));
  return frame;
}

TEST(MultibodyModel, DoublePendulumPositionsMatchTrigonometry) {
  for (const std::string& text : {PendulumText3(), PendulumText4()}) {
    const MultibodyModel model = BuildModel(text);
    const double shoulder = 0.7;
    const double elbow = -1.1;
    const auto positions = *model.MarkerPositions(PendulumVector(model, shoulder, elbow));
    ASSERT_THAT(model.marker_names(), ElementsAre("tip", "joint"));
    const Vec3 joint = Vec3(0, 1, 0) + HangingLink(kUpper, shoulder, 0, 0).position;
    const Vec3 tip = joint + HangingLink(kLower, shoulder + elbow, 0, 0).position;
    ExpectNear(positions[0], tip, kRounding, "tip");
    ExpectNear(positions[1], joint, kRounding, "joint");
  }
}

TEST(MultibodyModel, DoublePendulumVelocitiesMatchTrigonometry) {
  for (const std::string& text : {PendulumText3(), PendulumText4()}) {
    const MultibodyModel model = BuildModel(text);
    const std::vector<int> bodies{*model.BodyIndex("ground"), *model.BodyIndex("upper"),
                                  *model.BodyIndex("lower")};
    const auto motion =
        *model.BodyMotionAt(PendulumVector(model, 0.7, -1.1), PendulumVector(model, 2.0, -3.0), bodies,
                            PendulumVector(model, 5.0, 7.0));
    const Link link = HangingLink(kUpper, 0.7, 2.0, 5.0);
    ExpectNear(motion[2].position, Vec3(0, 1, 0) + link.position, kRounding, "position");
    ExpectNear(motion[2].velocity, link.velocity, kRounding, "velocity");
    ExpectNear(motion[2].acceleration, link.acceleration, 10 * kRounding, "acceleration");
    ExpectNear(motion[2].angular_velocity, Vec3(0, 0, -1), kRounding, "angular velocity");
    ExpectNear(motion[2].angular_acceleration, Vec3(0, 0, 12), 10 * kRounding, "angular acceleration");
    const Mat3 turned = Eigen::AngleAxisd(0.7 - 1.1, Vec3::UnitZ()).toRotationMatrix();
    EXPECT_NEAR((motion[2].rotation - turned).norm(), 0, kRounding);
    ExpectNear(motion[1].angular_velocity, Vec3(0, 0, 2), kRounding, "upper angular velocity");
    ExpectNear(motion[0].position, Vec3::Zero(), 0, "ground");
  }
}

TEST(MultibodyModel, KeepsTheFilesOrderAndDefaults) {
  const MultibodyModel model = BuildModel(PendulumText4());  // its joints stand child first
  EXPECT_THAT(model.coordinate_names(), ElementsAre("elbow_angle", "shoulder_angle"));
  EXPECT_THAT(model.body_names(), ElementsAre("ground", "upper", "lower"));
  EXPECT_EQ(model.default_values(), Vector(PendulumVector(model, 0.3, 0)));
  EXPECT_EQ(model.total_mass_kg(), 3.5);
}

// Every joint type against its transform multiplied out by hand, between two frames that are offset and
// turned.
TEST(MultibodyModel, JointTypesFollowOpenSimsConventions) {
  struct Case {
    const char* type;
    std::vector<double> q;
    Eigen::Isometry3d motion;
  };
  const Vec3 none = Vec3::Zero();
  const Case cases[] = {
      {"WeldJoint", {}, Placed(none, 0, 0, 0)},
      {"PinJoint", {0.8}, Placed(none, 0, 0, 0.8)},
      {"SliderJoint", {0.8}, Placed({0.8, 0, 0}, 0, 0, 0)},
      {"UniversalJoint", {0.8, -0.5}, Placed(none, 0.8, -0.5, 0)},
      {"BallJoint", {0.8, -0.5, 0.3}, Placed(none, 0.8, -0.5, 0.3)},
      {"GimbalJoint", {0.8, -0.5, 0.3}, Placed(none, 0.8, -0.5, 0.3)},
      {"PlanarJoint", {0.8, -0.5, 0.3}, Placed({-0.5, 0.3, 0}, 0, 0, 0.8)},
      {"FreeJoint", {0.8, -0.5, 0.3, 1.1, 1.2, 1.3}, Placed({1.1, 1.2, 1.3}, 0.8, -0.5, 0.3)},
  };
  const Eigen::Isometry3d parent = Placed({1, 2, 3}, 0.2, -0.3, 0.4);
  const Eigen::Isometry3d child = Placed({-0.1, 0.2, 0.3}, -0.5, 0.1, 0.6);
  for (const Case& joint : cases) {
    SCOPED_TRACE(joint.type);
    const auto n = static_cast<int>(joint.q.size());
    const MultibodyModel model = BuildModel(OneJoint(joint.type, n));
    const Vector q = Eigen::Map<const Vector>(joint.q.data(), n);
    const auto motion = *model.BodyMotionAt(q, Vector::Zero(n), {1});
    const Eigen::Isometry3d expected = parent * joint.motion * child.inverse();
    ExpectNear(motion[0].position, expected.translation(), kRounding, "position");
    EXPECT_NEAR((motion[0].rotation - expected.linear()).norm(), 0, kRounding);
  }
}

TEST(MultibodyModel, RejectsAJointWithTheWrongNumberOfCoordinates) {
  const auto read = ReadOsim(OneJoint("UniversalJoint", 1), "m.osim");
  EXPECT_THAT(read.error().message, HasSubstr("UniversalJoint 'j' has 1 coordinate(s), expected 2"));
}

// Through splines, a coupler, a ball and a free joint: rates and accelerations against differences.
TEST(MultibodyModel, VelocitiesAndAccelerationsAgreeWithDifferences) {
  const MultibodyModel model = BuildModel(kLeg);
  const auto n = static_cast<Eigen::Index>(model.coordinate_names().size());
  const Vector start = Vector::LinSpaced(n, -0.6, 0.5);
  const Vector rate = Vector::LinSpaced(n, 1.5, -2.0);
  const Vector acceleration = Vector::LinSpaced(n, -3, 4);
  std::vector<int> bodies;
  for (int i = 0; i < static_cast<int>(model.body_names().size()); ++i) bodies.push_back(i);
  const auto motion_at = [&](double t) {
    return *model.BodyMotionAt(start + t * rate + 0.5 * t * t * acceleration, rate + t * acceleration, bodies,
                               acceleration);
  };
  constexpr double kStep = 1e-5;
  constexpr double kTolerance = 1e-7;  // step^2 times a third derivative of order 100, plus eps / step
  const auto now = motion_at(0);
  const auto before = motion_at(-kStep);
  const auto after = motion_at(kStep);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const std::string& body = model.body_names()[i];
    ExpectNear(now[i].velocity, (after[i].position - before[i].position) / (2 * kStep), kTolerance, body);
    ExpectNear(now[i].acceleration, (after[i].velocity - before[i].velocity) / (2 * kStep), kTolerance, body);
    ExpectNear(now[i].angular_acceleration,
               (after[i].angular_velocity - before[i].angular_velocity) / (2 * kStep), kTolerance, body);
    const Mat3 spin = (after[i].rotation - before[i].rotation) / (2 * kStep) * now[i].rotation.transpose();
    ExpectNear(now[i].angular_velocity, Vec3(spin(2, 1), spin(0, 2), spin(1, 0)), kTolerance, body);
  }
}

TEST(MultibodyModel, IsThreadSafe) {
  const MultibodyModel model = BuildModel(kLeg);
  const auto n = static_cast<Eigen::Index>(model.coordinate_names().size());
  const int foot = *model.BodyIndex("foot");
  const auto position = [&](int i) {
    const Vector values = Vector::LinSpaced(n, -0.001 * i, 0.5);
    return (*model.BodyMotionAt(values, values, {foot}))[0].position;
  };
  constexpr int kCalls = 400;
  std::vector<Vec3> expected;
  for (int i = 0; i < kCalls; ++i) expected.push_back(position(i));
  std::vector<std::thread> threads;
  std::vector<int> wrong(4, 0);
  for (int& count : wrong) {
    threads.emplace_back([&] {
      for (int i = 0; i < kCalls; ++i) count += position(i) == expected[static_cast<std::size_t>(i)] ? 0 : 1;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_THAT(wrong, ElementsAre(0, 0, 0, 0));
}

TEST(MultibodyModel, DependentCoordinatesFollowTheirCoupler) {
  const MultibodyModel model = BuildModel(kLeg);
  Vector values = model.default_values();
  values[*model.CoordinateIndex("knee")] = -0.5;
  const int patella = *model.CoordinateIndex("knee_beta");
  values[patella] = 123;  // ignored
  const auto motion = *model.BodyMotionAt(values, Vector::Zero(values.size()), {*model.BodyIndex("patella")});
  // Coupler: 0.9 times the line from (-1, -1.1) to (3, 2.9); joint: 0.1 b^2 + 0.8 b + 0.05.
  const double beta = 0.9 * (-1.1 + 0.5);
  const double angle = 0.1 * beta * beta + 0.8 * beta + 0.05;
  const Mat3 turned = Eigen::AngleAxisd(angle, Vec3::UnitZ()).toRotationMatrix();
  EXPECT_NEAR((motion[0].rotation - turned).norm(), 0, kRounding);
  EXPECT_NEAR(model.default_values()[patella], 0.9 * (-1.1 + 1), kRounding);
}

TEST(MultibodyModel, ReplacesAnImpossibleInertiaWithANote) {
  const MultibodyModel model =
      BuildModel(Replaced(kLeg, "<inertia>0.001 0.001 0.01 0 0 0", "<inertia>0.0001 0.0002 0.001 0 0 0"));
  ASSERT_EQ(model.notes().size(), 1U);
  EXPECT_THAT(model.notes()[0],
              HasSubstr("body 'toe' has impossible moments of inertia 0.0001, 0.0002, 0.001"));
}

TEST(MultibodyModel, RejectsCouplersInACircle) {
  OsimModel model = *ReadOsim(kLeg, "leg");
  model.couplers.push_back({"back", "knee_beta", "knee", PiecewisePolynomial::Linear(1, 0)});
  EXPECT_THAT(MultibodyModel::Build(model).error().message,
              HasSubstr("couplers depend on each other in a circle"));
  model.couplers.back().dependent = "knee_beta";
  model.couplers.back().independent = "hip_x";
  EXPECT_THAT(MultibodyModel::Build(model).error().message, HasSubstr("'knee_beta' depends on two couplers"));
}

TEST(MultibodyModel, RejectsBadArguments) {
  const MultibodyModel model = BuildModel(PendulumText4());
  const Vector zero = Vector::Zero(2);
  EXPECT_THAT(model.BodyMotionAt(Vector::Zero(3), zero, {1}).error().message,
              HasSubstr("3 coordinate values, expected 2"));
  EXPECT_THAT(model.BodyMotionAt(zero, Vector::Constant(2, NAN), {1}).error().message,
              HasSubstr("rates are not finite"));
  EXPECT_THAT(model.BodyMotionAt(zero, zero, {3}).error().message, HasSubstr("body index 3, expected 0..2"));
  EXPECT_THAT(model.BodyMotionAt(zero, zero, {1}, Vector::Zero(1)).error().message,
              HasSubstr("accelerations"));
  EXPECT_THAT(model.MarkerPositions(Vector::Zero(1)).error().message, HasSubstr("expected 2"));
  EXPECT_THAT(model.BodyIndex("uper").error().message, HasSubstr("no body 'uper'; did you mean 'upper'?"));
}

}  // namespace
}  // namespace sinew
