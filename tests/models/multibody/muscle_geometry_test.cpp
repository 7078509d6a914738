#include "models/multibody/muscle_geometry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/constants.h"
#include "models/multibody/osim_muscle_reader.h"
#include "tests/models/multibody/test_muscles.h"

namespace sinew {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kRadius = 0.05;  // of drum and ball
constexpr double kNear = 0.2;     // distances from the axis of the ends of `around`
constexpr double kFar = 0.3;
// A few operations on numbers of order 1.
constexpr double kArmRounding = 1e-14;

struct Result1 {
  double length;
  double velocity;
  double arm;
};

// One muscle at one angle that changes at 2 rad/s.
Result1 Evaluate(const std::string& text, const std::string& muscle, double angle) {
  const MultibodyModel model = BuildModel(text);
  const auto paths = ReadOsimMuscles(text, "test.osim", *ReadOsim(text, "test.osim"), {muscle});
  if (!paths) throw std::runtime_error(paths.error().message);
  const auto geometry = MuscleGeometry::Build(model, *paths);
  Vector values = Vector::Zero(2);
  values[0] = angle;
  const auto state = geometry->At(values, Vector::Unit(2, 0) * 2, {0});
  if (!state) throw std::runtime_error(state.error().message);
  return {state->lengths[0], state->velocities[0], state->moment_arms(0, 0)};
}

// Two tangents and the arc between, for an angle between the ends as seen from the axis.
double PlanarLength(double between) {
  const double tangents =
      std::sqrt(kNear * kNear - kRadius * kRadius) + std::sqrt(kFar * kFar - kRadius * kRadius);
  return tangents + kRadius * (between - std::acos(kRadius / kNear) - std::acos(kRadius / kFar));
}

TEST(MuscleGeometry, PlanarPathOverACylinderOrASphere) {
  for (const std::string object : {"drum", "ball"}) {
    for (const double angle : {2.9, -2.8}) {  // either way round
      const Result1 at = Evaluate(MusclesOver(object), "around", angle);
      const double sign = angle > 0 ? 1 : -1;
      EXPECT_NEAR(at.length, PlanarLength(std::abs(angle)), kArmRounding) << object;
      EXPECT_NEAR(at.arm, -sign * kRadius, kArmRounding) << object;
      EXPECT_NEAR(at.velocity, 2 * sign * kRadius, kArmRounding) << object;
    }
    const Result1 straight = Evaluate(MusclesOver(object), "around", 1.0);
    EXPECT_NEAR(straight.length, std::sqrt(kNear * kNear + kFar * kFar - 2 * kNear * kFar * std::cos(1.0)),
                kArmRounding);
    EXPECT_NEAR(straight.arm, -kNear * kFar * std::sin(1.0) / straight.length, kArmRounding);
  }
}

TEST(MuscleGeometry, LengthIsSmoothWhereTheContactBegins) {
  const double begin = std::acos(kRadius / kNear) + std::acos(kRadius / kFar);
  constexpr double kLittle = 1e-6;
  for (const std::string object : {"drum", "ball"}) {
    const Result1 before = Evaluate(MusclesOver(object), "around", begin - kLittle);
    const Result1 after = Evaluate(MusclesOver(object), "around", begin + kLittle);
    EXPECT_NEAR(after.length - before.length, 2 * kLittle * kRadius, kLittle * kLittle);
    EXPECT_NEAR(after.arm, before.arm, 2 * kLittle);
  }
}

TEST(MuscleGeometry, HelixIsAStraightLineOnTheUnrolledCylinder) {
  const Result1 at = Evaluate(MusclesOver("drum"), "helix", 2.9);
  const double planar = PlanarLength(2.9);
  const double climb = 0.3;
  EXPECT_NEAR(at.length, std::hypot(planar, climb), kArmRounding);
  EXPECT_NEAR(at.arm, -kRadius * planar / at.length, kArmRounding);
}

TEST(MuscleGeometry, ASideThatIsGivenMayBeTheLongWayRound) {
  // The ends are 2.9 rad apart on the side of +y; round -y it is 2 pi - 2.9.
  const Result1 above = Evaluate(MusclesOver("drum", "+y"), "around", 2.9);
  const Result1 below = Evaluate(MusclesOver("drum", "-y"), "around", 2.9);
  EXPECT_NEAR(above.length, PlanarLength(2.9), kArmRounding);
  EXPECT_NEAR(below.length, PlanarLength(2 * kPi - 2.9), kArmRounding);
  EXPECT_NEAR(below.arm, kRadius, kArmRounding);
  // The line passes the drum on the wrong side: it is pulled round, or left alone on its own side.
  EXPECT_NEAR(Evaluate(MusclesOver("drum", "-y"), "around", 2.0).length, PlanarLength(2 * kPi - 2.0),
              kArmRounding);
  EXPECT_NEAR(Evaluate(MusclesOver("drum", "y"), "around", 1.0).length,
              std::sqrt(kNear * kNear + kFar * kFar - 2 * kNear * kFar * std::cos(1.0)), kArmRounding);
}

TEST(MuscleGeometry, ACylinderEndsAtItsLength) {
  const double straight = std::sqrt(kNear * kNear + kFar * kFar - 2 * kNear * kFar * std::cos(2.9) + 0.09);
  EXPECT_GT(Evaluate(MusclesOver("drum", "all", "0.1"), "helix", 2.9).length, straight + 1e-3);
  EXPECT_NEAR(Evaluate(MusclesOver("drum", "all", "0.001"), "helix", 2.9).length, straight, kArmRounding);
}

TEST(MuscleGeometry, AnInactiveObjectOrAPointInsideDoesNotWrap) {
  std::string text = MusclesOver("drum");
  text = Replaced(text, "<radius>0.05</radius>", "<radius>0.25</radius>");
  EXPECT_NEAR(Evaluate(text, "around", 2.9).length,
              std::sqrt(kNear * kNear + kFar * kFar - 2 * kNear * kFar * std::cos(2.9)), kArmRounding);
  EXPECT_NEAR(Evaluate(MusclesOver("idle"), "around", 2.9).length,
              std::sqrt(kNear * kNear + kFar * kFar - 2 * kNear * kFar * std::cos(2.9)), kArmRounding);
}

TEST(MuscleGeometry, AConditionalPointIsThereWithinItsRange) {
  const auto to_arm = [](double x, double y, double angle) {
    return std::hypot(kFar * std::cos(angle) - x, kFar * std::sin(angle) - y);
  };
  EXPECT_NEAR(Evaluate(MusclesOver("drum"), "through", 0.9).length, to_arm(0, 0.4, 0.9), kArmRounding);
  EXPECT_NEAR(Evaluate(MusclesOver("drum"), "through", 1.1).length,
              std::hypot(0.1, 0.3) + to_arm(0.1, 0.1, 1.1), kArmRounding);
  // OpenSim widens the range by 1e-5.
  EXPECT_NEAR(Evaluate(MusclesOver("drum"), "through", 1 - 9e-6).length,
              std::hypot(0.1, 0.3) + to_arm(0.1, 0.1, 1 - 9e-6), kArmRounding);
}

TEST(MuscleGeometry, AMovingPointAddsItsOwnMotion) {
  const Result1 at = Evaluate(MusclesOver("drum"), "sliding", 0.5);
  EXPECT_NEAR(at.length, 0.1 * 0.25 + 0.2 * 0.5 + 0.3, kArmRounding);
  EXPECT_NEAR(at.arm, -(2 * 0.1 * 0.5 + 0.2), kArmRounding);
  // Beyond the coordinate's range (-3..2) it stays where it is, as in OpenSim.
  const Result1 beyond = Evaluate(MusclesOver("drum"), "sliding", 2.5);
  EXPECT_NEAR(beyond.length, 0.1 * 4 + 0.2 * 2 + 0.3, kArmRounding);
  EXPECT_NEAR(beyond.arm, 0, kArmRounding);
}

TEST(MuscleGeometry, ADependentCoordinateMovesAlong) {
  const Result1 at = Evaluate(MusclesOver("drum"), "coupled", 0.5);
  EXPECT_NEAR(at.length, 0.5 + 1 + 0.1 * 0.5, kArmRounding);
  EXPECT_NEAR(at.arm, -0.1, kArmRounding);
  EXPECT_NEAR(at.velocity, 0.2, kArmRounding);
}

TEST(MuscleGeometry, WrongRequests) {
  const std::string text = MusclesOver("drum");
  const MultibodyModel model = BuildModel(text);
  const auto paths = ReadOsimMuscles(text, "test.osim", *ReadOsim(text, "test.osim"), {"around", "through"});
  auto geometry = MuscleGeometry::Build(model, *paths);
  ASSERT_TRUE(geometry);
  EXPECT_THAT(geometry->names(), ElementsAre("around", "through"));
  const Vector zero = Vector::Zero(2);
  EXPECT_THAT(geometry->At(Vector::Zero(1), zero, {}).error().message, "1 coordinate values, expected 2");
  EXPECT_THAT(geometry->At(zero, zero, {2}).error().message, "coordinate index 2, expected 0..1");
  EXPECT_THAT(geometry->At(zero, zero, {1}).error().message,
              "coordinate 'way' follows from another one through a coupler; expected an independent one");
  auto lonely = *paths;
  lonely[0].points[0].condition = OsimPointCondition{"angle", 1, 2};
  geometry = MuscleGeometry::Build(model, lonely);
  EXPECT_THAT(geometry->At(zero, zero, {}).error().message,
              "1 point(s) of muscle 'around' are in the path, expected at least 2");
  lonely[0].points[0].frame.body = "leg";
  EXPECT_THAT(MuscleGeometry::Build(model, lonely).error().message,
              HasSubstr("muscle 'around': the model has no body 'leg'"));
}

}  // namespace
}  // namespace sinew
