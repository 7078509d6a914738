#include "models/emg/movement_period.h"

#include <gtest/gtest.h>

#include "tests/models/emg/motions.h"

namespace sinew {
namespace {

TEST(MovementPeriodTest, FindsThePeriodAtEveryRate) {
  for (const double rate : {50.0, 500.0, 2000.0}) {
    for (const double period : {0.75, 1.3, 3.0}) {
      for (const double noise : {0.0, 2.0}) {
        const Recording r = Record(Cosine(period), 0.2, 15.4, rate, noise);
        const MovementPeriod found = FindMovementPeriod(r.time, r.angle);
        EXPECT_NEAR(found.period_s, period, 0.005 * period) << rate << " " << noise;
        // At the nearest of the lags, up to 1 / 12 of the period off in the worst case.
        EXPECT_GT(found.correlation, noise > 0 ? 0.95 : 0.99);
      }
    }
  }
}

// Two high points in a period: the half of it is no period.
TEST(MovementPeriodTest, TwoHighPointsAreOnePeriod) {
  const Motion motion{
      1.2, 0, [](double t) { return 10 * std::cos(2 * kPi * t / 1.2) + 20 * std::cos(4 * kPi * t / 1.2); }};
  const Recording r = Record(motion, 0.1, 20, 100);
  EXPECT_NEAR(FindMovementPeriod(r.time, r.angle).period_s, 1.2, 0.01);
}

TEST(MovementPeriodTest, GapsAndADriftDoNotHideIt) {
  Recording r = Record(Cosine(1.3), 0.1, 20, 200);
  for (std::size_t k = 0; k < r.angle.size(); ++k) r.angle[k] += 0.1 * r.time[k];
  for (std::size_t k = 700; k < 1100; ++k) r.angle[k] = NAN;
  EXPECT_NEAR(FindMovementPeriod(r.time, r.angle).period_s, 1.3, 0.01);
}

TEST(MovementPeriodTest, NothingRepeats) {
  EXPECT_EQ(FindMovementPeriod({}, {}).period_s, 0);
  std::vector<double> time;
  std::vector<double> noise;
  std::vector<double> constant;
  std::vector<double> line;
  Random random(3);
  for (int k = 0; k < 3000; ++k) {
    time.push_back(0.01 * k);
    noise.push_back(random.Normal());
    constant.push_back(4);
    line.push_back(k);
  }
  for (const auto& angle : {noise, constant, line, std::vector<double>(3000, NAN)})
    EXPECT_EQ(FindMovementPeriod(time, angle).period_s, 0);
}

}  // namespace
}  // namespace sinew
