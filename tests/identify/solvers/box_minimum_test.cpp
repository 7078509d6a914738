#include "identify/solvers/box_minimum.h"

#include <gtest/gtest.h>

#include "base/linear_algebra.h"
#include "tests/identify/support/toy_problem.h"

namespace sinew::solvers {
namespace {

using toy::Values;

constexpr double kTolerance = 1e-14;  // of the gain
constexpr double kRounding = 1e-7;    // what the ridge of 1e-10 and the tolerance leave of a step

// Two variables that are coupled, and one by itself: cost = d0^2/2 + d0 d1/2 + d1^2/2 + 0.1 d1 + d2^2/2 + g2
// d2.
BoxQuadraticModel Coupled(double g2) {
  BoxQuadraticModel model;
  model.normal.resize(3, 3);
  model.normal << 1, 0.5, 0, 0.5, 1, 0, 0, 0, 1;
  model.gradient = Values({0, 0.1, g2});
  return model;
}

TEST(BoxMinimum, HoldsAVariableOnItsBoundWhileTheCostFallsBeyondIt) {
  const BoxQuadraticModel model = Coupled(0);
  const Vector x = Values({0.5, 0, 0.5});
  BoxMinimum minimum(model, x, 0);
  Vector step = Values({0.2, 0, 0});
  // Slope of the second: 0.1 + 0.5 * 0.2 > 0, so it stays at 0. Cost 0.2^2 / 2.
  EXPECT_NEAR(minimum.Find(step, kTolerance), 0.02, kRounding);
  EXPECT_EQ(step[1], 0);
  EXPECT_NEAR(minimum.slope(), 0.2, kRounding);
}

TEST(BoxMinimum, ReleasesItWhereTheOtherLetsTheCostFallInward) {
  const BoxQuadraticModel model = Coupled(0);
  const Vector x = Values({0.5, 0, 0.5});
  BoxMinimum minimum(model, x, 0);
  Vector step = Values({-0.4, 0, 0});
  // Slope of the second: 0.1 - 0.5 * 0.4 = -0.1, curvature 1: it moves by 0.1 and gains 0.1^2 / 2 of 0.4^2
  // / 2.
  EXPECT_NEAR(minimum.Find(step, kTolerance), 0.075, kRounding);
  EXPECT_NEAR(step[1], 0.1, kRounding);
  EXPECT_NEAR(minimum.slope(), -0.4 + 0.5 * 0.1, kRounding);
}

TEST(BoxMinimum, EndsOnABoundThatAStepWouldLeave) {
  const BoxQuadraticModel model = Coupled(2);
  const Vector x = Values({0.5, 0, 0.5});
  BoxMinimum minimum(model, x, 0);
  Vector step = Vector::Zero(3);
  // The third would move by -2 and has room for 0.5: 2 * -0.5 + 0.5^2 / 2.
  EXPECT_NEAR(minimum.Find(step, kTolerance), -0.875, kRounding);
  EXPECT_EQ(step[2], -0.5);
}

TEST(BoxMinimum, DampingShortensTheOthers) {
  const BoxQuadraticModel model = Coupled(0);
  const Vector x = Values({0.5, 0, 0.5});
  BoxMinimum minimum(model, x, 0, 1);
  Vector step = Values({-0.4, 0, 0});
  // Curvature 2 instead of 1 for the second, and the held one as it was.
  EXPECT_NEAR(minimum.Find(step, kTolerance), 0.08 - 0.0025, kRounding);
  EXPECT_NEAR(step[1], 0.05, kRounding);
}

}  // namespace
}  // namespace sinew::solvers
