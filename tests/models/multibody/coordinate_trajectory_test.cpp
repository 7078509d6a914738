#include "models/multibody/coordinate_trajectory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/models/multibody/test_models.h"

namespace sinew {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::vector<double> kTimes{0, 0.1, 0.2, 0.3, 0.4, 0.5};

Matrix Samples(Eigen::Index columns) {
  Matrix values(static_cast<Eigen::Index>(kTimes.size()), columns);
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    for (Eigen::Index j = 0; j < columns; ++j)
      values(i, j) = std::sin(3 * kTimes[static_cast<std::size_t>(i)] + static_cast<double>(j));
  }
  return values;
}

TEST(CoordinateTrajectory, PassesThroughSamplesInTheModelsOrder) {
  const MultibodyModel model = BuildModel(PendulumText4());
  const auto trajectory =
      *CoordinateTrajectory::Fit(model, kTimes, {"force", "shoulder_angle", "elbow_angle"}, Samples(3));
  const CoordinateState state = trajectory.At(0.2);
  constexpr double kRounding = 1e-14;
  EXPECT_NEAR(state.values[*model.CoordinateIndex("shoulder_angle")], std::sin(0.6 + 1), kRounding);
  EXPECT_NEAR(state.values[*model.CoordinateIndex("elbow_angle")], std::sin(0.6 + 2), kRounding);
  EXPECT_THAT(trajectory.unused(), ElementsAre("force"));
  EXPECT_TRUE(trajectory.held().empty());
  EXPECT_EQ(trajectory.first_time(), 0);
  EXPECT_EQ(trajectory.last_time(), 0.5);
}

TEST(CoordinateTrajectory, MissingCoordinatesStayAtTheirDefaultUnlessCoupled) {
  const MultibodyModel model = BuildModel(kLeg);
  const auto trajectory =
      *CoordinateTrajectory::Fit(model, kTimes, {"rx", "ry", "rz", "tx", "ty", "tz", "knee"}, Samples(7));
  EXPECT_THAT(trajectory.held(), ElementsAre("hip_x", "hip_y", "hip_z", "ankle", "mtp"));
  const CoordinateState state = trajectory.At(0.33);
  EXPECT_EQ(state.values[*model.CoordinateIndex("mtp")], 0.2);
  EXPECT_EQ(state.rates[*model.CoordinateIndex("mtp")], 0);
}

TEST(CoordinateTrajectory, PrescribesBodiesConsistently) {
  const MultibodyModel model = BuildModel(kLeg);
  const auto trajectory =
      *CoordinateTrajectory::Fit(model, kTimes, {"rx", "hip_z", "tz", "knee"}, Samples(4) * 0.4);
  constexpr double kStep = 1e-5;
  constexpr double kTolerance = 1e-6;  // step^2 times third derivatives, plus eps / step; splines are only C2
  const int foot = *model.BodyIndex("foot");
  const auto motions = *model.BodyMotions({0.23 - kStep, 0.23, 0.23 + kStep}, trajectory, {foot});
  ASSERT_EQ(motions.size(), 3U);
  const Vec3 velocity = (motions[2][0].position - motions[0][0].position) / (2 * kStep);
  const Vec3 acceleration = (motions[2][0].velocity - motions[0][0].velocity) / (2 * kStep);
  EXPECT_NEAR((motions[1][0].velocity - velocity).norm(), 0, kTolerance);
  EXPECT_NEAR((motions[1][0].acceleration - acceleration).norm(), 0, kTolerance);
  EXPECT_GT(velocity.norm(), 0.1);
}

TEST(CoordinateTrajectory, RejectsBadInput) {
  const MultibodyModel model = BuildModel(PendulumText4());
  EXPECT_THAT(
      CoordinateTrajectory::Fit(model, kTimes, {"a", "b"}, Samples(2)).error().message,
      HasSubstr("share no coordinate: the model has elbow_angle, shoulder_angle (2), the motion has a, b"));
  EXPECT_THAT(CoordinateTrajectory::Fit(model, kTimes, {"elbow_angle"}, Samples(2)).error().message,
              HasSubstr("expected 6 times x 1 names"));
  EXPECT_THAT(
      CoordinateTrajectory::Fit(model, kTimes, {"elbow_angle", "elbow_angle"}, Samples(2)).error().message,
      HasSubstr("two columns"));
  Matrix gap = Samples(1);
  gap(2, 0) = NAN;
  EXPECT_THAT(CoordinateTrajectory::Fit(model, kTimes, {"elbow_angle"}, gap).error().message,
              HasSubstr("'elbow_angle' has a gap at t = 0.2 s"));
  EXPECT_THAT(CoordinateTrajectory::Fit(model, {0, 0.1, 0.1, 0.3, 0.4, 0.5}, {"elbow_angle"}, Samples(1))
                  .error()
                  .message,
              HasSubstr("coordinate 'elbow_angle': "));
}

}  // namespace
}  // namespace sinew
