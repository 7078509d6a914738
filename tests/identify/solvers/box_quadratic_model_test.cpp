#include "identify/solvers/box_quadratic_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/linear_algebra.h"
#include "tests/identify/support/toy_problem.h"

namespace sinew::solvers {
namespace {

using toy::Values;

// Cost d' N d / 2 + g' d of two variables that nearly replace each other.
BoxQuadraticModel Opposed() {
  BoxQuadraticModel model;
  model.normal.resize(2, 2);
  model.normal << 1, -0.99, -0.99, 1;
  model.gradient = Values({-0.1, -0.1});
  return model;
}

TEST(BoxQuadraticModel, TheStepEndsInTheBox) {
  const BoxQuadraticModel model = Opposed();
  const Vector x = Values({0.5, 0.5});
  double gain = 0;
  // Without bounds both move by 10.
  const Vector step = model.BoxStep(x, -1, 0, gain);
  EXPECT_EQ(step, Values({0.5, 0.5}));
  EXPECT_NEAR(gain, 0.1 - 0.25 * 0.01, 1e-12);
}

// The first runs to its lower bound and the second to its upper one, though with the first there the second
// is best in between.
TEST(BoxQuadraticModel, AVariableThatABoundOfAnotherOneBringsBackIsReleased) {
  BoxQuadraticModel model;
  model.normal.resize(2, 2);
  model.normal << 1, 0.9, 0.9, 1;
  // Its minimum without bounds: d = (-2, 1.2).
  model.gradient = -model.normal * Values({-2, 1.2});
  const Vector x = Values({0.5, 0.9});
  double gain = 0;
  const Vector step = model.BoxStep(x, -1, 0, gain);
  EXPECT_EQ(step[0], -0.5);
  EXPECT_NEAR(step[1], -0.15, 1e-6);
  EXPECT_GT(gain, 0);
  EXPECT_NEAR(gain, -model.gradient.dot(step) - 0.5 * step.dot(model.normal * step), 1e-12);
}

TEST(BoxQuadraticModel, AVariableThatIsHeldDoesNotMove) {
  const BoxQuadraticModel model = Opposed();
  const Vector x = Values({0.5, 0.5});
  double gain = 0;
  const Vector step = model.BoxStep(x, 0, 0, gain);
  EXPECT_EQ(step[0], 0);
  EXPECT_NEAR(step[1], 0.1, 1e-12);
}

// Residual d + d^2 of one variable at d = 0, on the way to its zero at -1: along a step v its second
// derivative is 2 v^2, so that half the acceleration is -v^2.
TEST(BoxQuadraticModel, HalfTheAccelerationOfAParabola) {
  BoxQuadraticModel model;
  model.normal = Matrix::Ones(1, 1);
  model.gradient = Vector::Constant(1, 0.1);
  const Vector x = Vector::Constant(1, 0.5);
  const Vector step = Vector::Constant(1, -0.1);
  const auto half = model.Acceleration(x, step, 0, Vector::Constant(1, 2 * 0.1 * 0.1));
  ASSERT_TRUE(half);
  EXPECT_NEAR((*half)[0], -0.01, 1e-15);
  // Not small beside the step.
  EXPECT_FALSE(model.Acceleration(x, step, 0, Vector::Constant(1, 0.04)));
  EXPECT_FALSE(model.Acceleration(x, step, 0, Vector::Constant(1, std::nan(""))));
  // Ends on a bound.
  EXPECT_FALSE(model.Acceleration(x, Vector::Constant(1, -0.5), 0, Vector::Constant(1, 0.02)));
}

}  // namespace
}  // namespace sinew::solvers
