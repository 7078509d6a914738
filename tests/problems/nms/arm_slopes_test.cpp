#include "problems/nms/arm_slopes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sinew {
namespace {

Vector Swing(double middle, double half, double rate) {
  Vector angle(200);
  for (Eigen::Index i = 0; i < angle.size(); ++i)
    angle[i] = middle + half * std::sin(rate * 0.01 * static_cast<double>(i));
  return angle;
}

TEST(ArmSlopesTest, TheSlopeOfAPolynomialIsExact) {
  const std::vector<std::vector<Vector>> angles{{Swing(0.2, 0.5, 5)}, {Swing(-0.1, 0.3, 9)}};
  std::vector<Vector> arm;
  for (const auto& trial : angles)
    arm.emplace_back(0.04 + trial[0].array() * (0.02 - 0.03 * trial[0].array().square()));
  const auto slopes = ArmSlopes(arm, angles);
  ASSERT_EQ(slopes.size(), 2u);
  for (std::size_t t = 0; t < 2; ++t) {
    const Vector exact = 0.02 - 0.09 * angles[t][0].array().square();
    EXPECT_LT((slopes[t] - exact).lpNorm<Eigen::Infinity>(), 1e-10);
  }
}

// A two-joint muscle: what the other joint changes is not taken for a slope over the own angle.
TEST(ArmSlopesTest, OtherJointsAreAllowedFor) {
  const std::vector<std::vector<Vector>> angles{{Swing(0, 0.5, 5), Swing(0.4, 0.4, 6)}};
  const std::vector<Vector> arm{0.04 + angles[0][0].array() * (0.01 + 0.02 * angles[0][1].array()) +
                                0.05 * angles[0][1].array()};
  const auto slopes = ArmSlopes(arm, angles);
  ASSERT_EQ(slopes.size(), 1u);
  const Vector exact = 0.01 + 0.02 * angles[0][1].array();
  EXPECT_LT((slopes[0] - exact).lpNorm<Eigen::Infinity>(), 1e-9);
}

TEST(ArmSlopesTest, AnArmThatAnglesDoNotExplainHasNone) {
  const std::vector<std::vector<Vector>> angles{{Swing(0, 0.5, 5)}};
  EXPECT_TRUE(ArmSlopes({Swing(0.04, 0.01, 23)}, angles).empty());
}

TEST(ArmSlopesTest, AJointAtRestHasNone) {
  EXPECT_TRUE(ArmSlopes({Swing(0.04, 0.01, 5)}, {{Swing(0.3, 0.005, 5)}}).empty());
}

TEST(ArmSlopesTest, BetweenTwoPosturesItIsThatOfALine) {
  std::vector<std::vector<Vector>> angles;
  std::vector<Vector> arm;
  for (const double q : {-0.2, 0.3}) {
    angles.push_back({Vector::Constant(50, q)});
    arm.emplace_back(Vector::Constant(50, 0.03 + 0.02 * q));
  }
  const auto slopes = ArmSlopes(arm, angles);
  ASSERT_EQ(slopes.size(), 2u);
  for (const Vector& slope : slopes) EXPECT_LT((slope.array() - 0.02).abs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace sinew
