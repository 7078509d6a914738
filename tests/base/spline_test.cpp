#include "base/spline.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sinew {
namespace {

NaturalCubicSpline SineSpline(int samples) {
  std::vector<double> time;
  std::vector<double> values;
  for (int i = 0; i < samples; ++i) {
    time.push_back(M_PI * i / (samples - 1));
    values.push_back(std::sin(time.back()));
  }
  return *NaturalCubicSpline::Fit(time, values);
}

double WorstSineError(int samples) {
  const auto spline = SineSpline(samples);
  double worst = 0;
  for (double t = 0; t < M_PI; t += 1e-3) worst = std::max(worst, std::abs(spline.At(t).value - std::sin(t)));
  return worst;
}

TEST(NaturalCubicSpline, PassesThroughItsSamples) {
  const std::vector<double> time{0, 0.1, 0.5, 0.7, 1.5};
  const std::vector<double> values{1, -2, 0.5, 3, 2};
  const auto spline = *NaturalCubicSpline::Fit(time, values);
  for (std::size_t i = 0; i < time.size(); ++i) EXPECT_NEAR(spline.At(time[i]).value, values[i], 1e-14);
  EXPECT_NEAR(spline.At(0).second, 0, 1e-14);
  EXPECT_NEAR(spline.At(1.5).second, 0, 1e-12);
}

// The sine has zero second derivative at 0 and pi, so the natural end conditions are right and the order is
// four.
TEST(NaturalCubicSpline, ConvergesWithFourthOrder) {
  const double ratio = WorstSineError(21) / WorstSineError(41);
  EXPECT_NEAR(ratio, 16, 1.0);
}

TEST(NaturalCubicSpline, DerivativesAgreeWithDifferences) {
  const auto spline = SineSpline(9);
  const double h = 1e-5;
  constexpr double kTolerance = 1e-8;  // central differences: h^2 plus eps / h
  for (double t = 0.05; t < 3.1; t += 0.0931) {
    EXPECT_NEAR(spline.At(t).first, (spline.At(t + h).value - spline.At(t - h).value) / (2 * h), kTolerance);
    EXPECT_NEAR(spline.At(t).second, (spline.At(t + h).first - spline.At(t - h).first) / (2 * h), kTolerance);
  }
}

TEST(NaturalCubicSpline, ContinuesAsAStraightLine) {
  const auto spline = SineSpline(9);
  const double slope = spline.At(M_PI).first;
  EXPECT_NEAR(spline.At(M_PI + 1).value, spline.At(M_PI).value + slope, 1e-14);
  EXPECT_EQ(spline.At(M_PI + 1).second, 0);
  EXPECT_NEAR(spline.At(-1).value, -spline.At(0).first, 1e-14);
}

TEST(NaturalCubicSpline, RejectsInvalidSamples) {
  EXPECT_EQ(NaturalCubicSpline::Fit({0, 1}, {1}).error().message, "spline: 2 times but 1 values");
  EXPECT_EQ(NaturalCubicSpline::Fit({0}, {1}).error().message, "spline: 1 sample(s), expected at least 2");
  EXPECT_EQ(NaturalCubicSpline::Fit({0, 1, 1}, {1, 2, 3}).error().message,
            "spline: time does not increase at sample 2");
  EXPECT_EQ(NaturalCubicSpline::Fit({0, 1}, {1, NAN}).error().message, "spline: sample 1 is not finite");
}

}  // namespace
}  // namespace sinew
