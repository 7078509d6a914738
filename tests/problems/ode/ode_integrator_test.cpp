#include "problems/ode/ode_integrator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/identify/support/error_of.h"

namespace sinew {
namespace {

using testing::HasSubstr;
using State2 = std::array<double, 2>;

constexpr double kRate = 3;  // [rad/s]

// A harmonic oscillator: cos and sin.
const auto kOscillator = [](double, const auto& x, auto& dx) {
  dx[0] = x[1];
  dx[1] = -kRate * kRate * x[0];
};

// Error at t = 2 s of so many equal steps, and the integrator's estimate of its first one.
std::pair<double, double> ErrorOfSteps(int steps) {
  const double h = 2.0 / steps;
  OdeStages<double, 2> stages;
  State2 x{1, 0};
  double first = 0;
  for (int i = 0; i < steps; ++i) {
    kOscillator(i * h, x, stages.slope[0]);
    stages.Step(kOscillator, i * h, h, x);
    if (i == 0) first = std::abs(stages.Error(h)[0]);
    x = stages.next;
  }
  return {std::abs(x[0] - std::cos(2 * kRate)), first};
}

TEST(OdeIntegrator, HalvingTheStepDividesTheErrorByThirtyTwo) {
  // Order 5; the next term of the error is smaller by a factor of rate * step = 0.15 and 0.075.
  for (const int steps : {20, 40, 80}) {
    const auto [coarse, estimate] = ErrorOfSteps(2 * steps);
    const auto [fine, fine_estimate] = ErrorOfSteps(4 * steps);
    EXPECT_NEAR(std::log2(coarse / fine), 5, 0.3) << steps;
    // The estimate is of a single step of order 4: h^5, of an even solution h^6.
    EXPECT_NEAR(std::log2(estimate / fine_estimate), 5.5, 0.7) << steps;
  }
}

TEST(OdeIntegrator, QuinticsAreExact) {
  constexpr double kRounding = 1e-14;
  const auto quintic = [](double t, const std::array<double, 1>&, std::array<double, 1>& dx) {
    dx[0] = 5 * t * t * t * t - 3 * t * t + 1;
  };
  OdeStages<double, 1> stages;
  quintic(0.3, {}, stages.slope[0]);
  stages.Step(quintic, 0.3, 0.9, {2});
  const auto exact = [](double t) { return t * t * t * t * t - t * t * t + t; };
  EXPECT_NEAR(stages.next[0], 2 + exact(1.2) - exact(0.3), kRounding);
}

TEST(OdeIntegrator, ErrorsStayNearTheAccuracyThatWasAsked) {
  for (const double accuracy : {1e-5, 1e-7, 1e-9, 1e-11}) {
    std::vector<OdeStep> steps;
    double worst = 0;
    const std::vector<double> stops{0, 0.7, 0.71, 5};
    const Status status = IntegrateOde<2>(
        kOscillator, 0, stops, State2{1, 0}, OdeAccuracy<2>{accuracy, {1, kRate}}, steps,
        [&](int stop, const State2& x) {
          worst = std::max(worst, std::abs(x[0] - std::cos(kRate * stops[static_cast<std::size_t>(stop)])));
        });
    ASSERT_TRUE(status);
    // Five seconds of a tenth of the accuracy per step on average, at most 1000 steps.
    EXPECT_LT(worst, 100 * accuracy) << steps.size() << " steps";
    EXPECT_GT(worst, 1e-3 * accuracy) << "far more steps than needed: " << steps.size();
  }
}

TEST(OdeIntegrator, DualNumbersTakeTheSameStepsToTheLastBit) {
  std::vector<OdeStep> steps;
  std::vector<State2> plain;
  const std::vector<double> stops{0.1, 0.5, 2};
  const Status status = IntegrateOde<2>(kOscillator, 0, stops, State2{1, 0}, OdeAccuracy<2>{}, steps,
                                        [&](int, const State2& x) { plain.push_back(x); });
  ASSERT_TRUE(status);
  using D = Dual<1>;
  std::size_t at = 0;
  RepeatOde<2, D>(kOscillator, 0, stops, {D::Variable(1, 0), D(0)}, steps,
                  [&](int stop, const std::array<D, 2>& x) {
                    EXPECT_EQ(x[0].value, plain[at][0]);
                    EXPECT_EQ(x[1].value, plain[at][1]);
                    EXPECT_NEAR(x[0].d[0], std::cos(kRate * stops[static_cast<std::size_t>(stop)]), 1e-7);
                    ++at;
                  });
  EXPECT_EQ(at, stops.size());
}

TEST(OdeIntegrator, SaysWhereItFails) {
  std::vector<OdeStep> steps;
  const auto ignore = [](int, const std::array<double, 1>&) {};
  const auto run = [&](auto f) {
    return ErrorOf(IntegrateOde<1>(f, 0, {1, 2}, std::array<double, 1>{1}, OdeAccuracy<1>{}, steps, ignore));
  };
  // x' = x^2 from 1 has no solution beyond t = 1.
  EXPECT_THAT(run([](double, const auto& x, auto& dx) { dx[0] = 4 * x[0] * x[0]; }),
              HasSubstr("solution ends, at t = 0.2499"));
  EXPECT_THAT(run([](double t, const auto& x, auto& dx) { dx[0] = t > 1.5 ? NAN : -x[0]; }),
              HasSubstr("not finite after t = 1.5"));
  EXPECT_THAT(run([](double, const auto& x, auto& dx) { dx[0] = -1e9 * (x[0] - 2); }), HasSubstr("stiff"));
}

}  // namespace
}  // namespace sinew
