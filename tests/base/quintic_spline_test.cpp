#include "base/quintic_spline.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/spline.h"

namespace sinew {
namespace {

std::vector<double> Times(int samples) {
  std::vector<double> time;
  for (int i = 0; i < samples; ++i) time.push_back(2.0 * i / (samples - 1));
  return time;
}

template <class F>
std::vector<double> At(const std::vector<double>& time, const F& f) {
  std::vector<double> values;
  for (const double t : time) values.push_back(f(t));
  return values;
}

// Farthest error of the second derivative in the middle half, where the ends do not matter.
template <class Spline>
double WorstSecondDerivative(int samples) {
  const auto time = Times(samples);
  const auto spline = *Spline::Fit(time, At(time, [](double t) { return std::sin(3 * t); }));
  double worst = 0;
  for (double t = 0.5; t <= 1.5; t += 0.0037)
    worst = std::max(worst, std::abs(spline.At(t).second + 9 * std::sin(3 * t)));
  return worst;
}

TEST(NaturalQuinticSpline, PassesThroughItsSamples) {
  const std::vector<double> time{0, 0.1, 0.4, 0.5, 1.1, 1.3};
  const std::vector<double> values{1, -2, 0.5, 3, 3, -1};
  const auto spline = *NaturalQuinticSpline::Fit(time, values);
  for (std::size_t i = 0; i < time.size(); ++i) EXPECT_NEAR(spline.At(time[i]).value, values[i], 1e-12);
}

// A parabola has no third derivative: it is its own natural spline, ends included.
TEST(NaturalQuinticSpline, ReproducesParabolas) {
  const std::vector<double> time{0, 0.1, 0.4, 0.5, 1.1, 1.3};
  const auto spline =
      *NaturalQuinticSpline::Fit(time, At(time, [](double t) { return 1 - 2 * t + 3 * t * t; }));
  for (double t = -0.5; t <= 2; t += 0.01) {
    EXPECT_NEAR(spline.At(t).value, 1 - 2 * t + 3 * t * t, 1e-11) << t;
    EXPECT_NEAR(spline.At(t).first, 6 * t - 2, 1e-10) << t;
    EXPECT_NEAR(spline.At(t).second, 6, 1e-9) << t;
  }
}

TEST(NaturalQuinticSpline, TheSecondDerivativeConvergesWithFourthOrder) {
  const double coarse = WorstSecondDerivative<NaturalQuinticSpline>(81);
  const double fine = WorstSecondDerivative<NaturalQuinticSpline>(161);
  EXPECT_NEAR(std::log2(coarse / fine), 4, 0.3);
  // That of the cubic one is off by (omega h)^2 / 12, as the header states.
  EXPECT_NEAR(WorstSecondDerivative<NaturalCubicSpline>(41), 9 * std::pow(3 * 0.05, 2) / 12, 2e-3);
  EXPECT_LT(coarse, 1e-3);
}

TEST(NaturalQuinticSpline, DerivativesAgreeWithDifferences) {
  const std::vector<double> time{0, 0.1, 0.4, 0.5, 1.1, 1.3};
  const auto spline = *NaturalQuinticSpline::Fit(time, {1, -2, 0.5, 3, 3, -1});
  constexpr double kStep = 1e-6;
  for (double t = -0.2; t < 1.5; t += 0.0313) {
    const auto below = spline.At(t - kStep);
    const auto above = spline.At(t + kStep);
    const auto at = spline.At(t);
    EXPECT_NEAR(at.first, (above.value - below.value) / (2 * kStep), 1e-6 * (1 + std::abs(at.first))) << t;
    EXPECT_NEAR(at.second, (above.first - below.first) / (2 * kStep), 1e-6 * (1 + std::abs(at.second))) << t;
  }
}

// Third and fourth derivatives are continuous at the samples, and zero at the ends.
TEST(NaturalQuinticSpline, IsNaturalAndSmooth) {
  const std::vector<double> time{0, 0.1, 0.4, 0.5, 1.1, 1.3};
  const auto spline = *NaturalQuinticSpline::Fit(time, {1, -2, 0.5, 3, 3, -1});
  constexpr double kStep = 1e-4;
  const auto third = [&](double t) {
    return (spline.At(t + kStep).second - spline.At(t - kStep).second) / (2 * kStep);
  };
  for (const double t : {0.1, 0.4, 0.5, 1.1})
    EXPECT_NEAR(third(t - 2 * kStep), third(t + 2 * kStep), 1e-2 * (1 + std::abs(third(t))) + 40) << t;
  EXPECT_NEAR(third(2 * kStep), 0, 2);
  EXPECT_NEAR(third(1.3 - 2 * kStep), 0, 2);
}

TEST(NaturalQuinticSpline, RejectsInvalidSamples) {
  EXPECT_EQ(NaturalQuinticSpline::Fit({0, 1, 2}, {1}).error().message, "spline: 3 times but 1 values");
  EXPECT_EQ(NaturalQuinticSpline::Fit({0, 1}, {1, 2}).error().message,
            "spline: 2 sample(s), expected at least 3");
  EXPECT_EQ(NaturalQuinticSpline::Fit({0, 1, 1}, {1, 2, 3}).error().message,
            "spline: time does not increase at sample 2");
  EXPECT_EQ(NaturalQuinticSpline::Fit({0, 1, 2}, {1, NAN, 1}).error().message,
            "spline: sample 1 is not finite");
}

}  // namespace
}  // namespace sinew
