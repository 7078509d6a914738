// The friction to expect of a step whose pose is not known, against what any friction obeys.
#include "problems/contact/steps/expected_friction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "tests/problems/support/force_channels.h"
#include "tests/problems/support/stepping_data.h"

namespace sinew {
namespace {

class ExpectedFriction : public testing::Test {
 protected:
  ExpectedFriction()
      : data_(SteppingData({{"fine", 0}, {"train", 1}, {"validate", 1}}, 0)),
        problem_(MakeContact(data_, MovingSettings(data_)).value()),
        stance_(problem_->data().stances.front()),
        mean_(RestPoint(*problem_)) {
    for (Eigen::Index i = 0; i < kContactParametersPerGroup; ++i)
      mean_[i] = kTruth.at(problem_->parameters()[static_cast<std::size_t>(i)].name);
  }
  // @param spread standard deviation of every weight
  [[nodiscard]] StepEstimate MostProbable(double spread) const {
    return EstimateStep(*problem_, stance_, mean_, spread, {}).value();
  }
  [[nodiscard]] StepEstimate Expected(double spread) const {
    StepEstimate estimate = MostProbable(spread);
    EXPECT_TRUE(TakeExpectedFriction(*problem_, stance_, estimate));
    return estimate;
  }
  static double Traction(const StepEstimate& estimate) {
    return std::hypot(estimate.value[kFx].norm(), estimate.value[kFz].norm()) / estimate.value[kFy].norm();
  }

  Dataset data_;
  std::unique_ptr<ContactProblem> problem_;
  const Stance& stance_;
  Vector mean_;
};

TEST_F(ExpectedFriction, OfAKnownPoseIsThatOfThePose) {
  constexpr double kNarrow = 1e-5;
  const StepEstimate alone = MostProbable(kNarrow);
  const StepEstimate expected = Expected(kNarrow);
  for (const std::size_t channel : {kFx, kFz, kPlateMomentY}) {
    const double scale = alone.value[kFx].cwiseAbs().maxCoeff();
    EXPECT_LT((expected.value[channel] - alone.value[channel]).cwiseAbs().maxCoeff(), 1e-3 * scale);
    // What 1000 draws tell of a standard deviation.
    const double ratio = expected.deviation[channel].norm() / alone.deviation[channel].norm();
    EXPECT_NEAR(ratio, 1, 0.1);
  }
}

TEST_F(ExpectedFriction, LeavesTheVerticalForceAndItsPlace) {
  const StepEstimate alone = MostProbable(1);
  const StepEstimate expected = Expected(1);
  for (const std::size_t channel : {kFy, kCopX, kCopZ}) {
    EXPECT_EQ(expected.value[channel], alone.value[channel]);
    EXPECT_EQ(expected.deviation[channel], alone.deviation[channel]);
  }
  EXPECT_EQ(expected.parameters, alone.parameters);
}

TEST_F(ExpectedFriction, IsTheSmallerTheLessIsKnownOfTheSlip) {
  double before = Traction(MostProbable(1));
  for (const double spread : {1.0, 3.0, 10.0}) {
    const double traction = Traction(Expected(spread));
    EXPECT_LT(traction, 0.9 * before) << spread;
    before = traction;
  }
}

TEST_F(ExpectedFriction, ItsBandIsNotThatOfAnUnboundedForce) {
  // A slip of which next to nothing is known, and a foot that is as likely off the floor as pressed on it.
  constexpr double kWide = 10;
  const Vector linear = MostProbable(kWide).deviation[kFx];
  const Vector drawn = Expected(kWide).deviation[kFx];
  EXPECT_LT(drawn.maxCoeff(), 0.2 * linear.maxCoeff());
}

TEST_F(ExpectedFriction, IsTheSameInEveryRun) {
  EXPECT_EQ(Expected(1).value, Expected(1).value);
}

}  // namespace
}  // namespace sinew
