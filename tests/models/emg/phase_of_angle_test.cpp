#include "models/emg/phase_of_angle.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/constants.h"

namespace sinew {
namespace {

TEST(PhaseOfAngleTest, MatchesAHandCalculation) {
  const PhaseOfAngle phase = *PhaseOfAngle::Fit({10, 6, 0, 5, 8});
  EXPECT_EQ(phase.reversal(), 0.5);
  EXPECT_EQ(phase.At(10, true), 0);
  EXPECT_EQ(phase.At(8, true), 0.125);
  EXPECT_EQ(phase.At(3, true), 0.375);
  EXPECT_EQ(phase.At(0, true), 0.5);
  EXPECT_EQ(phase.At(0, false), 0.5);
  EXPECT_EQ(phase.At(2.5, false), 0.625);
  EXPECT_EQ(phase.At(6.5, false), 0.875);
  EXPECT_EQ(phase.At(8, false), 1);
  EXPECT_EQ(phase.At(20, false), 1);
  EXPECT_EQ(phase.At(-5, true), 0.5);
  EXPECT_EQ(phase.At(NAN, true), 0);
}

TEST(PhaseOfAngleTest, IsTheInverseOfACosine) {
  for (const double sign : {1.0, -1.0}) {
    std::vector<double> angle;
    for (int k = 0; k < 2000; ++k) angle.push_back(sign * std::cos(2 * kPi * k / 1999));
    const PhaseOfAngle phase = *PhaseOfAngle::Fit(angle);
    for (double x = 0.05; x < 0.45; x += 0.013) {
      EXPECT_NEAR(phase.At(sign * std::cos(2 * kPi * x), true), x, 2e-6);  // straight lines between samples
      EXPECT_NEAR(phase.At(sign * std::cos(2 * kPi * x), false), 1 - x, 2e-6);
    }
  }
}

// The second hump is passed over: the angle counts where it is reached first.
TEST(PhaseOfAngleTest, RemovesSmallReversals) {
  const PhaseOfAngle phase = *PhaseOfAngle::Fit({0, 4, 2, 8, 0});
  EXPECT_EQ(phase.At(2, true), 0.125);
  EXPECT_EQ(phase.At(4, true), 0.25);
  EXPECT_EQ(phase.At(6, true), 0.625);
}

TEST(PhaseOfAngleTest, RejectsWhatIsNoCycle) {
  const auto message = [](const std::vector<double>& angle) {
    const auto phase = PhaseOfAngle::Fit(angle);
    return phase ? "" : phase.error().message;
  };
  EXPECT_EQ(message({1, 2}), "2 samples of the angle, expected at least 3");
  EXPECT_EQ(message({1, NAN, 2}), "angle 1 is nan, expected a finite number");
  EXPECT_EQ(message({1, 1, 1}), "the angle never changes, expected a movement");
  EXPECT_EQ(message({1, 2, 3}), "the angle has no turning point within the cycle");
}

}  // namespace
}  // namespace sinew
