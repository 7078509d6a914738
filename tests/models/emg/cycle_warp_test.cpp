#include "models/emg/cycle_warp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "base/constants.h"

namespace sinew {
namespace {

using testing::HasSubstr;

const std::vector<double> kTime{0, 1, 2, 3, 4, 5};
const std::vector<double> kValues{0, 10, 0, 4, 8, 6};

std::string ErrorOf(const std::vector<double>& time, const std::vector<double>& values, double begin_s,
                    double end_s, std::size_t samples = 5) {
  const auto warped = WarpCycle(time, values, begin_s, end_s, samples);
  return warped ? "" : warped.error().message;
}

TEST(CycleWarpTest, MatchesAHandCalculation) {
  EXPECT_EQ(*WarpCycle(kTime, kValues, 1, 5, 5), (std::vector<double>{10, 0, 4, 8, 6}));
  EXPECT_EQ(*WarpCycle(kTime, kValues, 0.5, 2.5, 5), (std::vector<double>{5, 10, 5, 0, 2}));
  // Values at 0.5, 0.5 + 2.25, 5: between 2 and 3 s the share 0.75.
  EXPECT_EQ(*WarpCycle(kTime, kValues, 0.5, 5, 3), (std::vector<double>{5, 3, 6}));
  EXPECT_EQ(WarpCycle(kTime, kValues, 0, 5)->size(), 2000U);
}

// More samples in the cycle than are wanted, and fewer.
TEST(CycleWarpTest, AStraightLineStaysOne) {
  for (const double rate : {20.0, 2048.0, 20000.0}) {
    std::vector<double> time;
    std::vector<double> line;
    for (int k = 0; k <= 2 * rate; ++k) {
      time.push_back(k / rate);
      line.push_back(3 * time.back() - 1);
    }
    const auto warped = *WarpCycle(time, line, 0.123, 1.789);
    for (std::size_t k = 0; k < kWarpSamples; ++k)
      EXPECT_NEAR(warped[k], 3 * (0.123 + 1.666 * static_cast<double>(k) / 1999) - 1, 1e-13);
  }
}

TEST(CycleWarpTest, GapsAreErrors) {
  auto gap = kValues;
  gap[3] = NAN;
  for (const std::size_t samples : {2U, 3U, 7U, 2000U})
    EXPECT_THAT(ErrorOf(kTime, gap, 1, 5, samples), HasSubstr("lacks samples near")) << samples;
  EXPECT_THAT(ErrorOf(kTime, gap, 3.5, 5), HasSubstr("lacks samples near 3.500 s"));
  EXPECT_EQ(ErrorOf(kTime, gap, 0, 2), "");
  EXPECT_EQ(ErrorOf(kTime, gap, 4, 5), "");
  gap[3] = INFINITY;
  EXPECT_NE(ErrorOf(kTime, gap, 1, 5), "");
}

TEST(CycleWarpTest, RejectsWhatIsNoCycle) {
  EXPECT_EQ(ErrorOf(kTime, {1, 2}, 0, 1), "6 times for 2 values, expected as many");
  EXPECT_EQ(ErrorOf(kTime, kValues, 2, 2),
            "a cycle from 2.000 to 2.000 s: expected an end behind its beginning");
  EXPECT_EQ(ErrorOf(kTime, kValues, 0, 5.1), "the cycle from 0 to 5.100 s is not covered by the samples");
  EXPECT_EQ(ErrorOf(kTime, kValues, -0.1, 5),
            "the cycle from -0.1000 to 5.000 s is not covered by the samples");
  EXPECT_THAT(ErrorOf(kTime, kValues, NAN, 5), HasSubstr("expected an end"));
  EXPECT_EQ(ErrorOf(kTime, kValues, 0, 5, 1), "1 samples for a cycle, expected at least 2");
  EXPECT_NE(ErrorOf({}, {}, 0, 1), "");
}

TEST(CycleWarpTest, AtPhaseMatchesAHandCalculation) {
  const std::vector<double> curve{2, 4, 0};
  EXPECT_EQ(AtPhase(curve, 0), 2);
  EXPECT_EQ(AtPhase(curve, 0.25), 3);
  EXPECT_EQ(AtPhase(curve, 0.5), 4);
  EXPECT_EQ(AtPhase(curve, 0.75), 2);
  EXPECT_EQ(AtPhase(curve, 1), 0);
  EXPECT_EQ(AtPhase(curve, -1), 2);
  EXPECT_EQ(AtPhase(curve, 7), 0);
}

TEST(CycleWarpTest, UnwarpIsTheInverse) {
  EXPECT_EQ(UnwarpCycle({2, 4, 0}, 2, 2), (std::vector<double>{2, 3, 4, 2, 0}));
  EXPECT_EQ(UnwarpCycle({2, 4, 0}, 0.5, 4), (std::vector<double>{2, 4, 0}));
  EXPECT_EQ(UnwarpCycle({2, 4, 0}, 0.7, 2.5).size(), 2U);  // at 0 and 0.4 s
  // There and back through 2000 samples: straight lines twice, (2 pi / 2000)^2 / 8 and (2 pi / 1500)^2 / 8.
  std::vector<double> time;
  std::vector<double> wave;
  for (int k = 0; k <= 1500; ++k) {
    time.push_back(k / 1000.0);
    wave.push_back(std::sin(2 * kPi * k / 1500));
  }
  const auto back = UnwarpCycle(*WarpCycle(time, wave, 0, 1.5), 1.5, 1000);
  ASSERT_EQ(back.size(), wave.size());
  for (std::size_t k = 0; k < wave.size(); ++k) EXPECT_NEAR(back[k], wave[k], 4e-6);
}

TEST(CycleWarpTest, MeanAndDeviationMatchesAHandCalculation) {
  const MeanCurve curve = MeanOfCycles({{1, 2}, {3, 2}, {8, 2}});
  EXPECT_EQ(curve.cycles, 3U);
  EXPECT_NEAR(curve.mean[0], 4, 1e-15);
  EXPECT_NEAR(curve.mean[1], 2, 1e-15);
  EXPECT_NEAR(curve.deviation[0], std::sqrt(13), 1e-14);  // (9 + 1 + 16) / 2
  EXPECT_NEAR(curve.deviation[1], 0, 1e-15);
  EXPECT_TRUE(MeanOfCycles({{1, 2}}).deviation.empty());
  EXPECT_THROW((void)MeanOfCycles({}), std::invalid_argument);
  EXPECT_THROW((void)MeanOfCycles({{1, 2}, {1}}), std::invalid_argument);
}

}  // namespace
}  // namespace sinew
