#include "problems/contact/motion/progression.h"

#include <gtest/gtest.h>

#include <cmath>

#include "problems/contact/steps/foot_wrench.h"
#include "tests/problems/support/stepping_data.h"

namespace sinew {
namespace {

// A robot that walks along x while its pelvis, and the feet with it, are turned about the vertical.
Stance TurnedStance(double turn, double faster) {
  Dataset data = SteppingData({{"fine", 0}, {"train", 1}, {"validate", 0}, {"moments", 1}}, 0);
  Trial& trial = data.trials.begin()->second;
  trial.grids.erase("markers");
  auto& channels = trial.grids.at("coordinates").channels;
  for (double& value : channels.at("pelvis_rotation").values) value += turn;
  for (double& value : channels.at("pelvis_tx").values) value *= faster;
  return MakeContact(data, MovingSettings(data)).value()->data().stances.front();
}

double AngleOf(const Vec3& direction) {
  return std::atan2(-direction.z(), direction.x());
}

TEST(Progression, IsWhereThePelvisGoesAndNotWhereTheFootPoints) {
  const Stance stance = TurnedStance(0.3, 3);
  EXPECT_NEAR(AngleOf(stance.forward), 0.3, 0.05);
  EXPECT_NEAR(AngleOf(stance.progression), 0, 0.02);
  // A force along the way is forward; a vertical one in front of the foot turns about the foot's own axis.
  Eigen::Matrix<double, 6, 1> load = Eigen::Matrix<double, 6, 1>::Zero();
  load[kForceX] = 100;
  load[kForceY] = 500;
  const Vec3 ahead = 0.05 * stance.forward;
  load[kFirstMomentX] = ahead.x() * load[kForceY];
  load[kFirstMomentZ] = ahead.z() * load[kForceY];
  const Wrench wrench = IntoFoot(stance) * (WrenchAbout(Vec3::Zero()) * load);
  EXPECT_NEAR(wrench[0], 100, 0.1);
  EXPECT_NEAR(wrench[2], 0, 3);
  EXPECT_NEAR(wrench[3], 0, 1e-9);
  EXPECT_NEAR(std::abs(wrench[5]), 0.05 * 500, 1e-9);
}

TEST(Progression, OfABodyThatStaysIsWhereTheFootPoints) {
  const Stance stance = TurnedStance(0.3, 0.01);
  EXPECT_NEAR((stance.progression - stance.forward).norm(), 0, 1e-12);
}

TEST(Progression, OfABodyThatGoesElsewhereIsWhereTheFootPoints) {
  const Stance stance = TurnedStance(1.2, 3);
  EXPECT_NEAR(AngleOf(stance.forward), 1.2, 0.1);
  EXPECT_NEAR((stance.progression - stance.forward).norm(), 0, 1e-12);
}

}  // namespace
}  // namespace sinew
