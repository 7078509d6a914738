#include "models/muscle/muscle_curve.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/spline.h"
#include "models/muscle/hill_muscle.h"

namespace sinew {
namespace {

// CEINMS's force-velocity points.
const std::vector<double> kX{-10, -1, -0.6, -0.3, -0.1, 0, 0.1, 0.3, 0.6, 0.8, 10};
const std::vector<double> kY{0, 0, 0.08, 0.2, 0.55, 1, 1.4, 1.6, 1.7, 1.75, 1.75};
constexpr double kWindow = 0.1;

void ExpectSmooth(const MuscleCurve& curve, double from, double to, double curvature_step) {
  const double h = (to - from) / 20000;
  MuscleCurve::Point before = curve.At(from);
  for (int i = 1; i <= 20000; ++i) {
    const MuscleCurve::Point here = curve.At(from + h * i);
    // Values, slopes and curvatures are integrals of one another: steps of 1 / 20000 of the range.
    EXPECT_NEAR(here.value - before.value, 0.5 * h * (here.slope + before.slope), 1e-2 * h) << from + h * i;
    EXPECT_NEAR(here.slope - before.slope, 0.5 * h * (here.curvature + before.curvature),
                0.5 * h * curvature_step)
        << from + h * i;
    EXPECT_LT(std::abs(here.curvature - before.curvature), curvature_step) << from + h * i;
    before = here;
  }
}

TEST(MuscleCurveTest, NaturalIsTheNaturalSpline) {
  const auto curve = MuscleCurve::Natural(kX, kY);
  ASSERT_TRUE(curve);
  const auto spline = NaturalCubicSpline::Fit(kX, kY);
  for (double x = -11; x < 11; x += 0.013) {
    const auto ours = curve->At(x);
    const auto theirs = spline->At(x);
    EXPECT_NEAR(ours.value, theirs.value, 1e-12) << x;
    EXPECT_NEAR(ours.slope, theirs.first, 1e-11) << x;
    EXPECT_NEAR(ours.curvature, theirs.second, 1e-10) << x;
  }
}

TEST(MuscleCurveTest, SmoothHasTwoContinuousDerivatives) {
  const auto curve = MuscleCurve::Smooth(kX, kY);
  ASSERT_TRUE(curve);
  // The third derivative is at most a jump of the second over half the window, 60 / 0.05.
  ExpectSmooth(*curve, -1.2, 1, 60 / 0.05 * 2.2 / 20000 * 4);
}

TEST(MuscleCurveTest, SmoothRisesWhereThePointsRise) {
  const auto curve = MuscleCurve::Smooth(kX, kY, kWindow);
  ASSERT_TRUE(curve);
  for (double x = -12; x < 12; x += 1e-3) EXPECT_GE(curve->At(x).slope, -1e-12) << x;
  EXPECT_EQ((*curve)(-3), 0) << "flat where the points are flat";
  EXPECT_EQ((*curve)(-30), 0);
  EXPECT_NEAR((*curve)(5), 1.75, 1e-12);
  EXPECT_NEAR((*curve)(50), 1.75, 1e-12);
}

TEST(MuscleCurveTest, SmoothKeepsToThePoints) {
  const auto curve = MuscleCurve::Smooth(kX, kY);
  for (std::size_t i = 0; i < kX.size(); ++i) EXPECT_NEAR((*curve)(kX[i]), kY[i], 0.02) << kX[i];
  // Points on a line stay on it.
  const auto line = MuscleCurve::Smooth({0, 1, 3, 4}, {1, 3, 7, 9});
  for (double x = -1; x < 5; x += 0.1) EXPECT_NEAR((*line)(x), 1 + 2 * x, 1e-12) << x;
}

TEST(MuscleCurveTest, DerivativesOfDualNumbersAreTheSlope) {
  const auto curve = MuscleCurve::Smooth(kX, kY);
  const Dual<1> x = Dual<1>::Variable(-0.234, 0);
  const Dual<1> y = (*curve)(x);
  EXPECT_EQ(y.value, (*curve)(-0.234));
  EXPECT_NEAR(y.d[0], ((*curve)(-0.234 + 1e-6) - (*curve)(-0.234 - 1e-6)) / 2e-6, 1e-8);
}

TEST(MuscleCurveTest, WrongPointsAreErrors) {
  EXPECT_THAT(MuscleCurve::Smooth({0, 1, 1}, {0, 1, 2}).error().message,
              testing::HasSubstr("does not increase"));
  EXPECT_THAT(MuscleCurve::Natural({0, 1}, {0}).error().message, testing::HasSubstr("curve of a muscle"));
  EXPECT_THAT(MuscleCurve::Smooth({0, 1}, {0, 1}, -1).error().message, testing::HasSubstr("window"));
}

// Properties of muscle curves: greatest active force near the optimal length, a tendon force only when taut.
TEST(MuscleCurveTest, DefaultCurvesAreThoseOfAMuscle) {
  const MuscleCurves curves = MuscleCurves::Default();
  EXPECT_NEAR(curves.active_force_length(1), 0.99, 0.02);
  EXPECT_EQ(curves.active_force_length(0.3), 0);
  EXPECT_NEAR(curves.active_force_length(1.8), 0, 1e-12);
  EXPECT_NEAR(curves.force_velocity(0), 1, 0.02);
  EXPECT_NEAR(curves.passive_force_length(0.8), 0, 1e-12);
  EXPECT_NEAR(curves.passive_force_length(1.6), 2, 0.1);
  EXPECT_NEAR(curves.tendon_force_strain(-0.01), 0, 1e-12);
  EXPECT_GT(curves.tendon_force_strain(0.05), 1);
  for (double x = 0; x < 2; x += 1e-3) EXPECT_GE(curves.active_force_length(x), -1e-12) << x;
}

}  // namespace
}  // namespace sinew
