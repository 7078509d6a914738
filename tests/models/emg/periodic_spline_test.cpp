#include "models/emg/periodic_spline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/constants.h"

namespace sinew {
namespace {

TEST(PeriodicSpline, BasisSumsToOneEverywhere) {
  for (const double phase : {-1.3, 0.0, 0.1234, 0.5, 0.999, 7.25}) {
    const PeriodicBasis basis = PeriodicBasisAt(phase, 7);
    double values = 0;
    double slopes = 0;
    for (std::size_t i = 0; i < kSplineSupport; ++i) {
      values += basis.value[i];
      slopes += basis.slope[i];
      EXPECT_GE(basis.value[i], 0);
    }
    EXPECT_NEAR(values, 1, 1e-14);
    EXPECT_NEAR(slopes, 0, 1e-12);
  }
}

TEST(PeriodicSpline, IsSmoothAcrossTheEndOfTheCycleAndBetweenKnots) {
  const std::vector<double> control{0, 1, 0.2, 0.7, -0.3, 0.4};
  constexpr double kStep = 1e-5;
  for (const double phase : {0.0, 1.0 / 6, 0.5, 0.77}) {
    const PeriodicBasis before = PeriodicBasisAt(phase - kStep, 6);
    const PeriodicBasis after = PeriodicBasisAt(phase + kStep, 6);
    const double slope = PeriodicBasisAt(phase, 6).SlopeAt(control.data());
    EXPECT_NEAR((after.At(control.data()) - before.At(control.data())) / (2 * kStep), slope, 1e-6);
    EXPECT_NEAR(after.SlopeAt(control.data()), before.SlopeAt(control.data()), 2e-2);
  }
}

TEST(PeriodicSpline, FitFindsItsOwnControlPoints) {
  const Vector truth = (Vector(8) << 0.1, 0.5, 0.9, 0.3, 0, 0, 0.05, 0.2).finished();
  std::vector<double> phase;
  std::vector<double> values;
  for (int i = 0; i < 200; ++i) {
    phase.push_back(0.37 * i);
    values.push_back(PeriodicBasisAt(phase.back(), 8).At(truth.data()));
  }
  const auto fitted = FitPeriodicSpline(phase, values, 8);
  ASSERT_TRUE(fitted);
  EXPECT_LT((*fitted - truth).norm(), 1e-10);
}

TEST(PeriodicSpline, RunsSmoothlyOnWhereNoSampleSpeaks) {
  std::vector<double> phase;
  std::vector<double> values;
  for (int i = 0; i < 60; ++i) {
    phase.push_back(0.6 * i / 60);
    values.push_back(0.5 + 0.1 * std::sin(2 * kPi * phase.back()));
  }
  const auto fitted = FitPeriodicSpline(phase, values, 10);
  ASSERT_TRUE(fitted);
  for (const double at : {0.7, 0.8, 0.9}) {
    EXPECT_NEAR(PeriodicBasisAt(at, 10).At(fitted->data()), 0.5, 0.25);
  }
}

TEST(PeriodicSpline, BadInputIsRefused) {
  EXPECT_EQ(FitPeriodicSpline({0, 0.5}, {1}, 4).error().message, "2 phases and 1 values, expected as many");
  EXPECT_EQ(FitPeriodicSpline({0, 0.5}, {1, 2}, 3).error().message, "3 control points, expected at least 4");
  EXPECT_EQ(FitPeriodicSpline({0, 0.5}, {1, 2}, 4).error().message,
            "2 samples are too few for 4 control points");
  EXPECT_EQ(FitPeriodicSpline({0, 0.2, 0.5, 0.7}, {1, 2, NAN, 1}, 4).error().message,
            "sample 2 is no number");
}

}  // namespace
}  // namespace sinew
