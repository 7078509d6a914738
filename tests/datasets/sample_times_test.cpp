#include "datasets/io/sample_times.h"

#include <cmath>
#include <numeric>

#include "base/random.h"
#include "tests/datasets/support.h"

namespace sinew {
namespace {

constexpr double kRounding = 1e-12;  // s; rebuilt times are exact but for binary fractions

PrintedTimes Printed(std::vector<double> time, double last_digit) {
  PrintedTimes printed;
  printed.lines.resize(time.size());
  std::iota(printed.lines.begin(), printed.lines.end(), 8L);
  printed.time_s = std::move(time);
  printed.last_digit_s = last_digit;
  return printed;
}

std::vector<double> Rounded(int count, double start, double rate, double digit) {
  std::vector<double> time;
  for (int i = 0; i < count; ++i) time.push_back(std::round((start + i / rate) / digit) * digit);
  return time;
}

TEST(UsableTimes, RoundedTimesAreRebuiltAndReportedOnce) {
  std::vector<std::string> notes;
  const auto time = UsableTimes("grf.mot", Printed(Rounded(1501, 0, 600, 1e-4), 1e-4), notes);
  ASSERT_TRUE(time) << ErrorOf(time);
  for (std::size_t i = 0; i < time->size(); ++i)
    ASSERT_NEAR((*time)[i], static_cast<double>(i) / 600, kRounding);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0], "grf.mot: times are rounded to 0.0001 s; they were rebuilt at 600 Hz from 0 s");
}

// Any rate and start: the rebuilt times are uniform and within half a digit of the printed ones.
TEST(UsableTimes, RebuiltTimesStayWithinHalfADigit) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const double rate = random.Uniform(20, 200);
    const auto printed = Rounded(300, random.Uniform(-5, 5), rate, 1e-3);
    std::vector<std::string> notes;
    const auto time = UsableTimes("x.mot", Printed(printed, 1e-3), notes);
    ASSERT_TRUE(time) << ErrorOf(time);
    ASSERT_EQ(notes.size(), 1U) << rate;
    const double step = ((*time)[299] - (*time)[0]) / 299;
    for (std::size_t k = 0; k < 300; ++k) {
      ASSERT_LE(std::abs((*time)[k] - printed[k]), 0.5001e-3) << rate;
      ASSERT_NEAR((*time)[k], (*time)[0] + static_cast<double>(k) * step, kRounding);
    }
  }
}

TEST(UsableTimes, RoundingThatRepeatsATimeIsRebuilt) {
  std::vector<std::string> notes;
  const auto time = UsableTimes("x.mot", Printed(Rounded(500, 0, 250, 1e-2), 1e-2), notes);
  ASSERT_TRUE(time) << ErrorOf(time);
  EXPECT_NEAR((*time)[499], 499 / 250.0, 0.005);  // half the last digit
  EXPECT_EQ(notes.size(), 1U);
}

TEST(UsableTimes, UniformTimesAreLeftAlone) {
  std::vector<std::string> notes;
  const auto printed = Rounded(100, 0, 100, 1e-2);
  const auto time = UsableTimes("x.mot", Printed(printed, 1e-2), notes);
  ASSERT_TRUE(time);
  EXPECT_EQ(*time, printed);
  EXPECT_TRUE(notes.empty());
}

TEST(UsableTimes, JitterIsNotRounding) {
  Random random(5);
  std::vector<double> jittered = Rounded(200, 0, 50, 1e-4);
  for (double& t : jittered) t = std::round((t + random.Uniform(-0.002, 0.002)) / 1e-4) * 1e-4;
  std::vector<std::string> notes;
  const auto time = UsableTimes("x.mot", Printed(jittered, 1e-4), notes);
  ASSERT_TRUE(time) << ErrorOf(time);
  EXPECT_EQ(*time, jittered);
  EXPECT_TRUE(notes.empty());
}

TEST(UsableTimes, MissingAndRepeatedSamplesAreNotRounding) {
  std::vector<double> missing = Rounded(20, 0, 10, 0.1);
  missing.erase(missing.begin() + 7);
  std::vector<std::string> notes;
  const auto kept = UsableTimes("x.mot", Printed(missing, 0.1), notes);
  ASSERT_TRUE(kept);
  EXPECT_EQ(*kept, missing);
  EXPECT_TRUE(notes.empty());

  std::vector<double> repeated = Rounded(20, 0, 10, 0.1);
  repeated[8] = repeated[7];
  EXPECT_FALSE(UsableTimes("x.mot", Printed(repeated, 0.1), notes));
}

TEST(UsableTimes, TheHeadersRateAllowsDigitsThatWereCutOff) {
  PrintedTimes printed = Printed({}, 1e-3);
  for (int i = 0; i < 100; ++i) {
    printed.time_s.push_back(std::floor(i / 60.0 * 1000 + 1e-6) / 1000);
    printed.lines.push_back(i + 7);
  }
  printed.rate_Hz = 60;
  std::vector<std::string> notes;
  const auto time = UsableTimes("x.trc", printed, notes);
  ASSERT_TRUE(time);
  EXPECT_NEAR((*time)[98], 98 / 60.0, kRounding);
}

TEST(UsableTimes, TimesThatDoNotIncreaseAreErrorsWithTheirLine) {
  std::vector<std::string> notes;
  EXPECT_EQ(ErrorOf(UsableTimes("x.mot", Printed({0, 0.1, 0.35, 0.3}, 1e-2), notes)),
            "x.mot:11: time 0.3 s does not increase, the row before is at 0.35 s");
  EXPECT_EQ(ErrorOf(UsableTimes("x.mot", Printed({0, std::nan(""), 0.3}, 1e-2), notes)),
            "x.mot:9: the time is not a number");
  EXPECT_FALSE(UsableTimes("x.mot", Printed({1, 1, 1, 1, 1}, 1), notes));
}

}  // namespace
}  // namespace sinew
