#include "models/contact/pose_deviation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "base/random.h"

namespace sinew {
namespace {

Vec3 RandomVector(Random& random, double size) {
  return {random.Uniform(-size, size), random.Uniform(-size, size), random.Uniform(-size, size)};
}

// A foot that shifts and turns at constant rates, and a toe that turns on its axis, all smooth in time.
struct MovingFoot {
  Vec3 position0, velocity, spin, toe_B, axis_B, axis_point_B, centre_B;
  double toe_rate = 0;

  explicit MovingFoot(Random& random)
      : position0(RandomVector(random, 1)),
        velocity(RandomVector(random, 1)),
        spin(RandomVector(random, 3)),
        toe_B(RandomVector(random, 0.2)),
        axis_B(RandomVector(random, 1).normalized()),
        axis_point_B(RandomVector(random, 0.2)),
        centre_B(RandomVector(random, 0.1)),
        toe_rate(random.Uniform(-3, 3)) {}

  [[nodiscard]] BodyMotion Foot(double t) const {
    BodyMotion foot;
    foot.position = position0 + t * velocity;
    foot.rotation = Eigen::AngleAxisd(t * spin.norm(), spin.normalized()).toRotationMatrix();
    foot.velocity = velocity;
    foot.angular_velocity = spin;
    return foot;
  }
  [[nodiscard]] JointAxis Axis(double t) const {
    const BodyMotion foot = Foot(t);
    return {foot.rotation * axis_B, foot.position + foot.rotation * axis_point_B};
  }
  [[nodiscard]] BodyMotion Toe(double t) const {
    const BodyMotion foot = Foot(t);
    const JointAxis axis = Axis(t);
    BodyMotion toe;
    const Mat3 hinge = Eigen::AngleAxisd(t * toe_rate, axis.direction).toRotationMatrix();
    const Vec3 arm = hinge * foot.rotation * (toe_B - axis_point_B);
    toe.position = axis.point + arm;
    toe.rotation = hinge * foot.rotation;
    toe.angular_velocity = spin + toe_rate * axis.direction;
    toe.velocity = velocity + spin.cross(axis.point - foot.position) + toe.angular_velocity.cross(arm);
    return toe;
  }
  [[nodiscard]] BodyMotion Deviated(double t, const PoseDeviation& deviation,
                                    PoseJacobian* jacobian = nullptr) const {
    const BodyMotion foot = Foot(t);
    const Vec3 arm = foot.rotation * centre_B;
    return DeviatedMotion(deviation, FootTurn(deviation), Toe(t), Axis(t), foot.position + arm,
                          foot.velocity + spin.cross(arm), jacobian);
  }
};

PoseDeviation RandomDeviation(Random& random, double size) {
  PoseDeviation deviation;
  for (double& value : deviation.value) value = random.Uniform(-size, size);
  for (double& rate : deviation.rate) rate = random.Uniform(-size, size);
  return deviation;
}

PoseDeviation After(PoseDeviation deviation, double dt) {
  for (std::size_t i = 0; i < deviation.value.size(); ++i) deviation.value[i] += dt * deviation.rate[i];
  return deviation;
}

Vec3 RotationBetween(const Mat3& from, const Mat3& to) {
  const Eigen::AngleAxisd turn(Mat3(to * from.transpose()));
  return turn.angle() * turn.axis();
}

Eigen::Matrix<double, 12, 1> Change(const BodyMotion& from, const BodyMotion& to) {
  Eigen::Matrix<double, 12, 1> change;
  change << to.position - from.position, RotationBetween(from.rotation, to.rotation),
      to.velocity - from.velocity, to.angular_velocity - from.angular_velocity;
  return change;
}

TEST(PoseDeviation, NoDeviationIsTheRecordedMotion) {
  Random random(1);
  const MovingFoot foot(random);
  EXPECT_LT(Change(foot.Toe(0.2), foot.Deviated(0.2, {})).norm(), 1e-12);
}

TEST(PoseDeviation, VelocitiesAreTheDerivativesOfThePose) {
  constexpr double kStep = 1e-6;
  Random random(2);
  for (const double size : {1e-4, 0.05, 1.0}) {
    const MovingFoot foot(random);
    const PoseDeviation deviation = RandomDeviation(random, size);
    const BodyMotion now = foot.Deviated(0.1, deviation);
    const BodyMotion before = foot.Deviated(0.1 - kStep, After(deviation, -kStep));
    const BodyMotion after = foot.Deviated(0.1 + kStep, After(deviation, kStep));
    EXPECT_LT(((after.position - before.position) / (2 * kStep) - now.velocity).norm(), 1e-7);
    EXPECT_LT((RotationBetween(before.rotation, after.rotation) / (2 * kStep) - now.angular_velocity).norm(),
              1e-7);
  }
}

TEST(PoseDeviation, DerivativesAgreeWithDifferences) {
  constexpr double kStep = 1e-6;
  Random random(3);
  for (const double size : {0.0, 1e-5, 0.05, 1.5}) {
    const MovingFoot foot(random);
    const PoseDeviation deviation = RandomDeviation(random, size);
    PoseJacobian jacobian;
    (void)foot.Deviated(0.3, deviation, &jacobian);
    for (int c = 0; c < 2 * kPoseComponents; ++c) {
      const auto moved = [&](double by) {
        PoseDeviation other = deviation;
        const auto i = static_cast<std::size_t>(c % kPoseComponents);
        (c < kPoseComponents ? other.value : other.rate)[i] += by;
        return foot.Deviated(0.3, other);
      };
      const Eigen::Matrix<double, 12, 1> slope = Change(moved(-kStep), moved(kStep)) / (2 * kStep);
      EXPECT_LT((slope - jacobian.col(c)).norm(), 1e-7 * (1 + slope.norm()))
          << "size " << size << " column " << c;
    }
  }
}

TEST(PoseDeviation, ABodyWithoutAnAxisDoesNotFeelTheJoint) {
  Random random(4);
  const MovingFoot foot(random);
  PoseDeviation deviation;
  deviation.value[kJointAngle] = 0.4;
  deviation.rate[kJointAngle] = 2;
  PoseJacobian jacobian;
  const BodyMotion recorded = foot.Foot(0.1);
  const BodyMotion moved = DeviatedMotion(deviation, FootTurn(deviation), recorded, {}, recorded.position,
                                          recorded.velocity, &jacobian);
  EXPECT_LT(Change(recorded, moved).norm(), 1e-15);
  EXPECT_EQ(jacobian.col(kJointAngle).norm(), 0);
  EXPECT_EQ(jacobian.col(kPoseComponents + kJointAngle).norm(), 0);
}

}  // namespace
}  // namespace sinew
