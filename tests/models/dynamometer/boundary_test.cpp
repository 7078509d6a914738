#include "models/dynamometer/boundary.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/random.h"

namespace sinew {
namespace {

FootGeometry TwoStraps() {
  FootGeometry foot;
  foot.straps = DefaultStraps();
  return foot;
}

BoundaryLaw<double> Law() {
  BoundaryLaw<double> law;
  law.strap_damping = 0.5;
  law.axis_x = 0.012;
  law.axis_y = -0.009;
  return law;
}

BoundaryLaw<double> WithoutLosses() {
  BoundaryLaw<double> law = Law();
  law.friction = 0;
  law.sole_dissipation = 0;
  law.strap_damping = 0;
  return law;
}

FootPose<double> RandomPose(Random& random) {
  FootPose<double> pose;
  pose.plate_angle = random.Uniform(-0.6, 0.4);
  pose.ankle_angle = pose.plate_angle + random.Uniform(-0.1, 0.1);
  pose.plate_velocity = random.Uniform(-2, 2);
  pose.ankle_velocity = pose.plate_velocity + random.Uniform(-1, 1);
  return pose;
}

double Stored(const BoundaryLaw<double>& law, FootPose<double> pose, double plate, double ankle) {
  pose.plate_angle += plate;
  pose.ankle_angle += ankle;
  return BoundaryLoadAt(TwoStraps(), law, pose).stored;
}

TEST(BoundaryTest, MomentsAreOppositeAboutOneAxis) {
  BoundaryLaw<double> law = Law();
  law.axis_x = law.axis_y = 0;
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const auto load = BoundaryLoadAt(TwoStraps(), law, RandomPose(random));
    EXPECT_NEAR(load.on_foot, -load.on_plate, 1e-12 * (load.normal + load.strap));
    EXPECT_GE(load.normal, 0);
    EXPECT_GE(load.strap, 0);
  }
}

// The same force acts on the plate, the other way, at the same point: moments about two axes differ by that
// of the force at the one about the other.
TEST(BoundaryTest, ForcesAreOppositeAboutTwoAxes) {
  const BoundaryLaw<double> law = Law();
  FootGeometry barefoot = TwoStraps();
  barefoot.straps.clear();
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    const auto pose = RandomPose(random);
    const auto load = BoundaryLoadAt(barefoot, law, pose);
    const double c = std::cos(pose.plate_angle);
    const double s = std::sin(pose.plate_angle);
    const double force_x = load.shear * c - load.normal * s;
    const double force_y = load.shear * s + load.normal * c;
    EXPECT_NEAR(load.on_foot + load.on_plate, law.axis_x * force_y - law.axis_y * force_x,
                1e-12 * (1 + load.normal));
  }
}

// Without losses moments are the slopes of the stored energy, whatever the velocities: with a foot that
// touches, one that has lifted off in part, slack straps, and a sole that stiffens.
TEST(BoundaryTest, MomentsAreSlopesOfTheStoredEnergy) {
  constexpr double kStep = 1e-6;
  for (const double exponent : {0.0, 0.4}) {
    BoundaryLaw<double> law = WithoutLosses();
    law.sole_exponent = exponent;
    law.bent_sole = exponent != 0;
    Random random(3);
    for (int i = 0; i < 100; ++i) {
      const auto pose = RandomPose(random);
      const auto load = BoundaryLoadAt(TwoStraps(), law, pose);
      const double on_foot = (Stored(law, pose, 0, -kStep) - Stored(law, pose, 0, kStep)) / (2 * kStep);
      const double on_plate = (Stored(law, pose, -kStep, 0) - Stored(law, pose, kStep, 0)) / (2 * kStep);
      const double size = 1 + std::abs(load.on_foot);
      EXPECT_NEAR(load.on_foot, on_foot, 1e-5 * size);
      EXPECT_NEAR(load.on_plate, on_plate, 1e-5 * size);
      EXPECT_NEAR(load.dissipated, 0, 1e-12 * size);
    }
  }
}

// What foot and plate put in is stored or lost, and losses are no gains.
TEST(BoundaryTest, PowerIsStoredOrLost) {
  constexpr double kStep = 1e-6;
  const BoundaryLaw<double> law = Law();
  Random random(4);
  double largest = 0;
  for (int i = 0; i < 100; ++i) {
    const auto pose = RandomPose(random);
    const auto load = BoundaryLoadAt(TwoStraps(), law, pose);
    const double p = pose.plate_velocity * kStep;
    const double q = pose.ankle_velocity * kStep;
    const double rate = (Stored(law, pose, p, q) - Stored(law, pose, -p, -q)) / (2 * kStep);
    const double given = -(load.on_foot * pose.ankle_velocity + load.on_plate * pose.plate_velocity);
    EXPECT_NEAR(given, rate + load.dissipated, 1e-5 * (1 + std::abs(given) + std::abs(rate)));
    EXPECT_GE(load.dissipated, -1e-12);
    largest = std::max(largest, load.dissipated);
  }
  EXPECT_GT(largest, 1);
}

TEST(BoundaryTest, SlackStrapsPullAtNothingAndKeepTheirEnergy) {
  FootGeometry foot = TwoStraps();
  BoundaryLaw<double> law = Law();
  // So weak that straps are slack 2 mm below the length at which they were strapped on.
  law.strap_pretension = 0.1 * law.strap_stiffness / law.strap_exponent;
  law.sole_stiffness = 1e-9;
  FootPose<double> pose;
  pose.ankle_velocity = 0.3;
  EXPECT_GT(BoundaryLoadAt(foot, law, pose).strap, 1);
  double energy = 0;
  for (const double angle : {-0.2, -0.25, -0.3}) {
    pose.ankle_angle = angle;
    const auto load = BoundaryLoadAt(foot, law, pose);
    EXPECT_EQ(load.strap, 0);
    EXPECT_NEAR(load.on_foot, 0, 1e-9);
    if (energy != 0) {
      EXPECT_NEAR(load.stored, energy, 1e-9);
    }
    energy = load.stored;
  }
}

TEST(BoundaryTest, AStrapFollowsItsLawAndLoosensWithTime) {
  FootGeometry foot = TwoStraps();
  foot.straps.resize(1);  // across the plate: it grows as long as it is pulled
  BoundaryLaw<double> law = Law();
  law.axis_x = law.axis_y = 0;
  FootPose<double> pose;
  EXPECT_NEAR(BoundaryLoadAt(foot, law, pose).strap, law.strap_pretension, 1e-9);
  law.strap_loosening = 1e-3;
  pose.since = 2;
  EXPECT_NEAR(BoundaryLoadAt(foot, law, pose).strap, law.strap_pretension + 5e3 / 50 * std::expm1(-50 * 2e-3),
              1e-9);
}

TEST(BoundaryTest, DampedSpringsNeverPullAtTheSole) {
  FootPose<double> pose;
  pose.ankle_velocity = 200;  // the forefoot leaves the plate, the heel is pushed into it
  const auto load = BoundaryLoadAt(TwoStraps(), Law(), pose);
  EXPECT_GE(load.normal, 0);
  EXPECT_GT(load.dissipated, 0);
}

}  // namespace
}  // namespace sinew
