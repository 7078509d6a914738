#include "problems/contact/phase_shape.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "problems/contact/load/effect_load.h"

namespace sinew {
namespace {

using testing::DoubleNear;
using testing::Pointwise;

TEST(PhaseShape, SharesAddUpToTheAngleAndVanishAtBothEnds) {
  constexpr double kRounding = 1e-14;
  const std::array<double, 2> loaded{0.3, 1.1};
  for (const double phase : {0.25, 0.3, 0.45, 0.5, 0.7, 0.75}) {
    const PhaseShare share = PhaseShareAt(0.3 + 0.8 * phase, loaded);
    EXPECT_NEAR(share.value[0] + share.value[1] + share.value[2], 1, kRounding) << phase;
  }
  EXPECT_THAT(PhaseShareAt(0.7, loaded).value, Pointwise(DoubleNear(kRounding), {0.0, 1.0, 0.0}));
  for (const double outside : {0.2, 0.3, 1.1, 1.3}) {
    EXPECT_THAT(PhaseShareAt(outside, loaded).value, Pointwise(DoubleNear(kRounding), {0.0, 0.0, 0.0}));
    EXPECT_THAT(PhaseShareAt(outside, loaded).rate, Pointwise(DoubleNear(kRounding), {0.0, 0.0, 0.0}));
  }
}

TEST(PhaseShape, RatesAreThoseOfTheShares) {
  constexpr double kStep = 1e-6;
  const std::array<double, 2> loaded{0.3, 1.1};
  for (double time = 0.31; time < 1.1; time += 0.047) {
    const PhaseShare before = PhaseShareAt(time - kStep, loaded);
    const PhaseShare after = PhaseShareAt(time + kStep, loaded);
    const PhaseShare at = PhaseShareAt(time, loaded);
    for (std::size_t j = 0; j < kShapePhases; ++j)
      EXPECT_NEAR(at.rate[j], (after.value[j] - before.value[j]) / (2 * kStep), 1e-4) << time << " " << j;
  }
}

TEST(PhaseShape, WhatIsAheadOfTheMiddleBends) {
  const std::vector<double> ahead = AheadOfMiddle({-0.05, 0, 0.1, 0.2}, -0.1, 0.2);
  EXPECT_THAT(ahead, Pointwise(DoubleNear(1e-15), {-0.1, -0.05, 0.05, 0.15}));
  EXPECT_EQ(ShapeArms(-0.1)[kBend], 0);
  EXPECT_EQ(ShapeArms(0.05)[kBend], 0.05);
  EXPECT_EQ(ShapeArms(-0.1)[kPitch], -0.1);
  EXPECT_EQ(ShapeArms(-0.1)[kLift], 1);
}

// The load of a sole of two regions, the front one of which is turned.
struct TwoRegions {
  ContactRegion rear;
  ContactRegion front;
  ElasticFoundation bed{1e6, 1, 0.6, 0.5, 0.2};
  Vec3 velocity{0.05, -0.02, 0.01};

  TwoRegions() {
    rear.mesh = *BoxMesh({0.1, 0.02, 0.08}, 10, 8);
    rear.springs = SpringFaces::kBottom;
    front = rear;
    rear.position = Vec3(-0.05, 0, 0);
    front.position = Vec3(0.05, 0, 0);
  }

  // What is recorded, and the same with the front region or both moved. @param up of the mode, and its rate
  [[nodiscard]] ContactLoad Moved(ShapeMode mode, double up, double rate) const {
    BodyMotion moved = Recorded();
    if (mode == kLift) {
      moved.position.y() += up;
      moved.velocity.y() += rate;
    } else {  // about the middle of the sole, where the body's origin is
      moved.rotation = Eigen::AngleAxisd(up, Vec3::UnitZ()).matrix();
      moved.angular_velocity = Vec3(0, 0, rate);
    }
    return LoadOf({mode == kBend ? Recorded() : moved, moved}, mode, 0, 0, false);
  }

  [[nodiscard]] ContactLoad WithEffect(ShapeMode mode, double up, double rate, bool vertical_only) const {
    return LoadOf({Recorded(), Recorded()}, mode, up, rate, vertical_only);
  }

  [[nodiscard]] BodyMotion Recorded() const {
    BodyMotion foot;
    foot.position = Vec3(0, -0.008, 0);
    foot.velocity = velocity;
    return foot;
  }

  [[nodiscard]] ContactLoad LoadOf(const std::array<BodyMotion, 2>& motion, ShapeMode mode, double up,
                                   double rate, bool vertical_only) const {
    EffectKinematics kinematics;
    for (const std::size_t r : {0U, 1U}) {
      const ContactRegion& region = r == 0 ? rear : front;
      EffectRegion& added = kinematics.regions.emplace_back();
      added.kinematics = ComputeContactKinematics(region, {motion[r]}, {});
      added.turning_x = {motion[r].angular_velocity.x()};
      added.turning_z = {motion[r].angular_velocity.z()};
      std::vector<double> along;
      for (const int face : region.SpringFaceIndices())
        along.push_back(region.position.x() + region.mesh.Centre(face).x());
      added.ahead = AheadOfMiddle(along, -0.1, 0.1);
    }
    kinematics.foot_position = {motion[0].position};
    kinematics.foot_acceleration = {motion[0].acceleration};
    kinematics.phase = {{{0, 1, 0}, {0, rate / (up == 0 ? 1 : up), 0}}};
    ContactEffectValues effects{};
    effects[ShapeEffect(mode, 1)] = up;
    EffectLoad load;
    load.by_part.resize(1);
    ComputeEffectLoad(kinematics, 0, {bed}, effects, {vertical_only, false}, load);
    return load.load;
  }
};

// Geometry that shares nothing with the effects but the springs: the sole, or its front, is a body that moves
// so.
TEST(PhaseShape, ADisplacedSoleIsABodyThatMovesSo) {
  const TwoRegions sole;
  const ContactLoad recorded = sole.Moved(kLift, 0, 0);
  for (const auto& [mode, size] :
       {std::pair(kBend, 0.01), std::pair(kPitch, 0.01), std::pair(kLift, 0.001)}) {
    for (const double up : {size, -size}) {
      for (const double rate : {0.0, 30 * size}) {
        const ContactLoad expected = sole.Moved(mode, up, rate);
        const ContactLoad displaced = sole.WithEffect(mode, up, rate, false);
        const double change = std::max(std::abs(expected[kForceY] - recorded[kForceY]),
                                       std::abs(expected[kFirstMomentX] - recorded[kFirstMomentX]) / 0.1);
        EXPECT_GT(change, 3);
        // Of the second order in the angle: springs move 0.05 % of their distance along x, and what turns
        // also slides.
        EXPECT_NEAR(displaced[kForceY], expected[kForceY], 1e-2 * change) << mode << " " << up << " " << rate;
        EXPECT_NEAR(displaced[kForceX], expected[kForceX], 3e-2 * change) << mode << " " << up << " " << rate;
        EXPECT_NEAR(displaced[kFirstMomentX], expected[kFirstMomentX], 2e-3 * change)
            << mode << " " << up << " " << rate;
        EXPECT_EQ(sole.WithEffect(mode, up, rate, true)[kForceY], displaced[kForceY]);
      }
    }
  }
}

}  // namespace
}  // namespace sinew
