// Attachment, passive ankle, path of a muscle.
#include <gtest/gtest.h>

#include <cmath>

#include "models/dynamometer/attachment.h"
#include "models/dynamometer/muscle_path.h"
#include "models/dynamometer/passive_ankle.h"

namespace sinew {
namespace {

TEST(AttachmentTest, FrictionIsItsParts) {
  Attachment<double> attachment;
  attachment.viscous_friction = 0.2;
  EXPECT_DOUBLE_EQ(attachment.Friction(-3, 40.0), -0.6);
  attachment.coulomb_friction = 1.5;
  attachment.load_friction = 0.05;
  EXPECT_NEAR(attachment.Friction(1, -40.0), 0.2 + 1.5 + 2, 1e-12);
  EXPECT_NEAR(attachment.Friction(-1, 40.0), -0.2 - 1.5 - 2, 1e-12);
  EXPECT_EQ(attachment.Friction(0, 40.0), 0);
  attachment.one_way_friction = 0.7;
  EXPECT_NEAR(attachment.Friction(1, 0.0), 0.2 + 1.5 + 0.7, 1e-12);
  EXPECT_NEAR(attachment.Friction(-1, 0.0), -0.2 - 1.5, 1e-12);
  // Half of what it is at speed, at about half of the slowest one.
  EXPECT_NEAR(attachment.Friction(-0.55 * Attachment<double>::kSlowest, 0.0), -1.5 * 0.5, 5e-3);
}

// Gravity's moment is the slope of its energy: G sin(p + g - tilt).
TEST(AttachmentTest, WeightPullsItsCentreDown) {
  Attachment<double> attachment;
  attachment.gravity = 3;
  attachment.gravity_angle = 0.2;
  EXPECT_DOUBLE_EQ(attachment.WeightMoment(0.1, 0.3), -3);
  EXPECT_NEAR(attachment.WeightMoment(-0.2 + std::acos(-1) / 2, 0), 0, 1e-15);
  const auto energy = [&](double p) { return 3 * std::sin(0.2 + p - 0.5); };
  const double h = 1e-5;
  EXPECT_NEAR(attachment.WeightMoment(0.7, 0.5), -(energy(0.7 + h) - energy(0.7 - h)) / (2 * h), 1e-9);
}

TEST(AttachmentTest, CablesPullItBack) {
  Attachment<double> attachment;
  EXPECT_EQ(attachment.CableMoment(0.4), 0);
  attachment.stiffness = 5;
  EXPECT_DOUBLE_EQ(attachment.CableMoment(0.4), -2);
}

TEST(PassiveAnkleTest, MomentIsOfItsFormula) {
  PassiveAnkle<double> ankle;
  ankle.stiffness = 12;
  ankle.exponent = 5;
  ankle.rest_angle = -0.2;
  ankle.linear_stiffness = 4;
  ankle.damping = 0.4;
  EXPECT_DOUBLE_EQ(ankle.Moment(-0.2, 0.0), 0);
  EXPECT_NEAR(ankle.Moment(0.1, 0.5), -(12 * (std::exp(1.5) - 1) / 5 + 4 * 0.3 + 0.4 * 0.5), 1e-12);
  ankle.hysteresis = 1.5;
  EXPECT_NEAR(ankle.Moment(-0.2, 1.0), -0.4 - 1.5, 1e-12);
  EXPECT_NEAR(ankle.Moment(-0.2, -1.0), 0.4 + 1.5, 1e-12);
  EXPECT_NEAR(ankle.Dissipated(-2.0), 0.4 * 4 + 1.5 * 2, 1e-12);
}

TEST(PassiveAnkleTest, StiffnessAtRestIsBothParts) {
  PassiveAnkle<double> ankle;
  const double h = 1e-6;
  const double slope =
      (ankle.Moment(ankle.rest_angle + h, 0.0) - ankle.Moment(ankle.rest_angle - h, 0.0)) / (2 * h);
  EXPECT_NEAR(-slope, ankle.stiffness + ankle.linear_stiffness, 1e-6);
}

TEST(PassiveAnkleTest, MomentIsTheSlopeOfTheStoredEnergy) {
  const PassiveAnkle<double> ankle;
  const double h = 1e-6;
  EXPECT_EQ(ankle.Stored(ankle.rest_angle), 0);
  for (const double q : {-0.6, -0.3, 0.0, 0.4})
    EXPECT_NEAR(ankle.Moment(q, 0.0), -(ankle.Stored(q + h) - ankle.Stored(q - h)) / (2 * h), 1e-8);
}

TEST(MusclePathTest, ArmIsMinusTheSlopeOfTheLength) {
  const MusclePath path{0.31, {0.041, -0.006, -0.02}};
  const double h = 1e-6;
  EXPECT_DOUBLE_EQ(path.Length(0.0), 0.31);
  EXPECT_NEAR(path.Arm(0.5), 0.041 - 0.003 - 0.005, 1e-15);
  for (const double q : {-0.5, 0.0, 0.3})
    EXPECT_NEAR(path.Arm(q), -(path.Length(q + h) - path.Length(q - h)) / (2 * h), 1e-10);
}

}  // namespace
}  // namespace sinew
