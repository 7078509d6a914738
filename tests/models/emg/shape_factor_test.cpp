#include "models/emg/shape_factor.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sinew {
namespace {

ShapeFactor Fit(const std::vector<double>& speeds, const std::vector<double>& factors,
                FactorLaw law = FactorLaw::kRegression) {
  return *ShapeFactor::Fit(speeds, factors, law);
}

std::string ErrorOf(const std::vector<double>& speeds, const std::vector<double>& factors) {
  const auto fit = ShapeFactor::Fit(speeds, factors, FactorLaw::kRegression);
  return fit ? "" : fit.error().message;
}

// Of (1, 1), (2, 3), (3, 2), (4, 4): slope 4 / 5, mean 2.5 both; residuals -0.3, 0.9, -0.9, 0.3.
TEST(ShapeFactorTest, RegressionMatchesAHandCalculation) {
  const ShapeFactor fit = Fit({3, 1, 4, 2}, {2, 1, 4, 3});
  EXPECT_NEAR(fit.slope(), 0.8, 1e-14);
  EXPECT_NEAR(fit.intercept(), 0.5, 1e-14);
  EXPECT_NEAR(fit.scatter(), std::sqrt(1.8 / 2), 1e-14);
  EXPECT_NEAR(fit.At(2.5), 2.5, 1e-14);
  EXPECT_NEAR(fit.At(10), 8.5, 1e-13);
  EXPECT_EQ(fit.slowest(), 1);
  EXPECT_EQ(fit.fastest(), 4);
}

TEST(ShapeFactorTest, ALineIsFoundExactly) {
  std::vector<double> factors;
  const std::vector<double> speeds{0.52, 0.79, 1.05, 1.31, 1.57, 2.09};
  for (const double speed : speeds) factors.push_back(0.7 + 0.2 * speed);
  const ShapeFactor fit = Fit(speeds, factors);
  for (const double speed : {0.1, 0.9, 2.0, 5.0}) EXPECT_NEAR(fit.At(speed), 0.7 + 0.2 * speed, 1e-14);
  EXPECT_NEAR(fit.scatter(), 0, 1e-14);
}

TEST(ShapeFactorTest, InterpolationMatchesAHandCalculation) {
  const ShapeFactor fit = Fit({4, 1, 2}, {2, 1, 3}, FactorLaw::kInterpolation);
  EXPECT_EQ(fit.At(1), 1);
  EXPECT_EQ(fit.At(1.25), 1.5);
  EXPECT_EQ(fit.At(2), 3);
  EXPECT_EQ(fit.At(3), 2.5);
  EXPECT_EQ(fit.At(4), 2);
  EXPECT_EQ(fit.At(0), 1);
  EXPECT_EQ(fit.At(9), 2);
}

TEST(ShapeFactorTest, NeverNegative) {
  EXPECT_EQ(Fit({1, 2}, {1, 0.2}).At(5), 0);
}

TEST(ShapeFactorTest, OneSpeedIsAConstant) {
  for (const auto law : {FactorLaw::kRegression, FactorLaw::kInterpolation}) {
    const ShapeFactor fit = Fit({2}, {1.5}, law);
    EXPECT_EQ(fit.At(0), 1.5);
    EXPECT_EQ(fit.At(7), 1.5);
    EXPECT_EQ(fit.scatter(), 0);
  }
}

TEST(ShapeFactorTest, HasTheRangeOfItsSpeeds) {
  const ShapeFactor fit = Fit({1, 3}, {1, 2});
  EXPECT_TRUE(fit.Covers(1) && fit.Covers(2) && fit.Covers(3));
  EXPECT_TRUE(fit.Covers(3 * (1 + 1e-12)));
  EXPECT_FALSE(fit.Covers(0.99));
  EXPECT_FALSE(fit.Covers(3.01));
  EXPECT_FALSE(fit.Covers(NAN));
}

TEST(ShapeFactorTest, RejectsWhatIsNoLaw) {
  EXPECT_EQ(ErrorOf({}, {}), "no speeds, expected at least one");
  EXPECT_EQ(ErrorOf({1, 2}, {1}), "2 speeds for 1 factors, expected as many");
  EXPECT_EQ(ErrorOf({1, NAN}, {1, 1}), "factor 1 at speed nan: expected finite numbers");
  EXPECT_EQ(ErrorOf({1, 2}, {1, INFINITY}), "factor inf at speed 2: expected finite numbers");
  EXPECT_EQ(ErrorOf({1, 2, 1}, {1, 1, 1}), "speed 1.000 comes twice, expected its cycles together");
}

}  // namespace
}  // namespace sinew
