// A foot that is moved to its noisy markers: the noise of its pose is what the program says.
#include "problems/contact/motion/marker_pose.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace sinew {
namespace {

constexpr double kRate = 60;     // [Hz]
constexpr double kNoise = 3e-4;  // [m] of a marker along an axis
constexpr std::size_t kFrames = 48;
constexpr std::size_t kEnd = 4;  // frames at an end, where a smooth curve is less certain

struct Standing {
  std::vector<double> time;
  FootMotion foot;
  FootMarkers markers;
};

// A foot at rest with a marker on the heel, the toes and each side.
Standing Foot() {
  Standing standing;
  BodyMotion at_rest{};
  at_rest.position = Vec3(0.1, 0.08, 0.05);
  at_rest.rotation = Mat3::Identity();
  for (std::size_t t = 0; t < kFrames; ++t) standing.time.push_back(static_cast<double>(t) / kRate);
  FootMotion& foot = standing.foot;
  foot.indices = {0};
  foot.bodies.resize(1);
  foot.bodies.front().motion.assign(kFrames, at_rest);
  foot.bodies.front().axis.resize(kFrames);
  foot.PlaceCentre();
  for (const Vec3& location : {Vec3(-0.1, 0, 0), Vec3(0.15, 0, 0), Vec3(0.1, 0, -0.05), Vec3(0.1, 0, 0.05)})
    standing.markers.markers.push_back({"", 0, location, {}});
  return standing;
}

void Measure(Standing& standing, Random& random) {
  for (FootMarkers::Marker& marker : standing.markers.markers) {
    const BodyMotion& body = standing.foot.bodies.front().motion.front();
    marker.measured.assign(kFrames, body.position + marker.location);
    for (Vec3& place : marker.measured) {
      for (double& x : place) x += kNoise * random.Normal();
    }
  }
}

TEST(MarkerPose, StatesTheNoiseThatItsMarkersLeave) {
  constexpr int kDraws = 60;
  const Standing exact = Foot();
  const BodyMotion at_rest = exact.foot.bodies.front().motion.front();
  Random random(11);
  Eigen::Matrix<double, 6, 1> squares = Eigen::Matrix<double, 6, 1>::Zero();
  double rates = 0;  // of the shift
  double marker = 0;
  PoseNoise stated;
  for (int draw = 0; draw < kDraws; ++draw) {
    Standing standing = exact;
    Measure(standing, random);
    stated = MoveToMarkers(standing.time, standing.foot, standing.markers).noise;
    marker += stated.marker / kDraws;
    // What stays the same in all frames is the markers' places.
    const auto& motion = standing.foot.bodies.front().motion;
    Eigen::Matrix<double, 6, kFrames> pose;
    for (std::size_t t = 0; t < kFrames; ++t) {
      const Mat3& turn = motion[t].rotation;
      pose.col(static_cast<Eigen::Index>(t)) << motion[t].position - at_rest.position, turn(2, 1), turn(0, 2),
          turn(1, 0);
      if (t >= kEnd && t + kEnd < kFrames) {
        rates += motion[t].velocity.squaredNorm() / (3 * (kFrames - 2 * kEnd) * kDraws);
      }
    }
    pose.colwise() -= pose.rowwise().mean().eval();
    squares += pose.rowwise().squaredNorm() / (kFrames * kDraws);
  }
  EXPECT_NEAR(marker, kNoise, 0.05 * kNoise);
  for (int c = 0; c < 6; ++c) {
    const double of = stated.deviation[static_cast<std::size_t>(c)] * kNoise / stated.marker;
    EXPECT_NEAR(std::sqrt(squares[c]), of, 0.25 * of) << c;
  }
  const double shift = stated.deviation[kShiftX] * kNoise / stated.marker;
  EXPECT_NEAR(std::sqrt(rates), shift / stated.time, 0.3 * shift / stated.time);
}

TEST(MarkerPose, WithoutNoiseThereIsNone) {
  Standing standing = Foot();
  Random random(12);
  Measure(standing, random);
  for (FootMarkers::Marker& marker : standing.markers.markers)
    marker.measured.assign(kFrames, marker.measured.front());
  const PoseNoise noise = MoveToMarkers(standing.time, standing.foot, standing.markers).noise;
  EXPECT_LT(noise.marker, 1e-6);
  EXPECT_EQ(noise.deviation[kJointAngle], 0);
}

}  // namespace
}  // namespace sinew
