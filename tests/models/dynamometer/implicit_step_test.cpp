#include "models/dynamometer/implicit_step.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sinew {
namespace {

// x' = rate (x - cos t) - sin t, from x(0) = cos 0 + off: the solution is cos t + off exp(rate t).
double Integrate(double rate, double off, double end, int steps) {
  const double h = end / steps;
  StagedState<double> state;
  state.begin = 1 + off;
  for (int i = 0; i < steps; ++i) {
    double last = 0;
    for (int stage = 0; stage < ImplicitStep::kStages; ++stage) {
      const auto at = static_cast<std::size_t>(stage);
      const double t = h * (i + ImplicitStep::kNodes[at]);
      const double past = state.Past(stage, h);
      // x = past + h g f(x, t), linear in x.
      const double way = h * ImplicitStep::kDiagonal;
      last = (past - way * (rate * std::cos(t) + std::sin(t))) / (1 - way * rate);
      state.slope[at] = (last - past) / way;
    }
    state.begin = last;
  }
  return state.begin;
}

double ErrorAfter(double rate, double off, double end, int steps) {
  return std::abs(Integrate(rate, off, end, steps) - (std::cos(end) + off * std::exp(rate * end)));
}

TEST(ImplicitStepTest, MeetsTheConditionsOfOrderThree) {
  const double g = ImplicitStep::kDiagonal;
  EXPECT_NEAR(((g - 3) * g + 1.5) * g, 1.0 / 6, 1e-15);
  const auto& a = ImplicitStep::kWeights;
  const auto& c = ImplicitStep::kNodes;
  EXPECT_NEAR(a[1][0] + g, c[1], 1e-15);
  EXPECT_NEAR(a[2][0] + a[2][1] + g, c[2], 1e-15);
  const double b[3] = {a[2][0], a[2][1], g};
  double half = 0;
  double third = 0;
  double sixth = 0;
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    half += b[i] * c[at];
    third += b[i] * c[at] * c[at];
    sixth += b[i] * g * c[at];
    for (int j = 0; j < i; ++j) sixth += b[i] * a[i][j] * c[static_cast<std::size_t>(j)];
  }
  EXPECT_NEAR(half, 0.5, 1e-15);
  EXPECT_NEAR(third, 1.0 / 3, 1e-15);
  EXPECT_NEAR(sixth, 1.0 / 6, 1e-15);
}

TEST(ImplicitStepTest, IsOfOrderThree) {
  for (const double rate : {-0.5, -20.0}) {
    const double ratio = ErrorAfter(rate, 0.7, 1, 400) / ErrorAfter(rate, 0.7, 1, 800);
    EXPECT_NEAR(ratio, 8, 0.5) << "rate " << rate;
  }
}

// Steps a thousand times as long as the equation's own time: what is off is gone after a step, and the error
// is not larger than that of an equation that is not stiff.
TEST(ImplicitStepTest, IsStableWhateverTheStep) {
  for (const double rate : {-1e4, -1e7, -1e10}) {
    EXPECT_LT(ErrorAfter(rate, 0.7, 1, 10), 2e-4) << "rate " << rate;
    EXPECT_GT(ErrorAfter(rate, 0.7, 1, 10) / ErrorAfter(rate, 0.7, 1, 40), 3.5) << "rate " << rate;
  }
}

}  // namespace
}  // namespace sinew
