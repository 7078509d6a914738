#include "identify/solvers/box_minimum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "base/linear_algebra.h"
#include "base/random.h"
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

// Of the minimum in the box: no slope inside, none but outward on a bound.
void ExpectMinimum(const BoxQuadraticModel& model, const Vector& x, const Vector& step) {
  const Vector slope = model.gradient + model.normal * step;
  int inside = 0;
  for (Eigen::Index v = 0; v < x.size(); ++v) {
    const double at = x[v] + step[v];
    ASSERT_GE(at, -1e-12);
    ASSERT_LE(at, 1 + 1e-12);
    if (at > 0 && at < 1) {
      EXPECT_NEAR(slope[v], 0, 1e-6) << v;
      ++inside;
    } else {
      EXPECT_GE(at <= 0 ? slope[v] : -slope[v], -1e-9) << v;
    }
  }
  EXPECT_GT(inside, 0);
  EXPECT_LT(inside, x.size());
}

TEST(BoxMinimum, OfManyVariablesOfWhichManyEndOnBounds) {
  constexpr Eigen::Index kVariables = 150;
  for (const int seed : {1, 2, 3, 4, 5}) {
    Random random(static_cast<std::uint64_t>(seed));
    Matrix rows(160, kVariables);
    for (double& value : rows.reshaped()) value = random.Normal();
    BoxQuadraticModel model;
    model.normal = rows.transpose() * rows;
    model.gradient.resize(kVariables);
    for (double& value : model.gradient) value = 20 * random.Normal();
    Vector x(kVariables);
    for (double& value : x) value = random.Uniform();
    Vector step = Vector::Zero(kVariables);
    const double value = BoxMinimum(model, x, -1).Find(step, 1e-12);
    EXPECT_NEAR(value, model.gradient.dot(step) + 0.5 * step.dot(model.normal * step),
                1e-9 * std::abs(value));
    ExpectMinimum(model, x, step);
  }
}

}  // namespace
}  // namespace sinew::solvers
