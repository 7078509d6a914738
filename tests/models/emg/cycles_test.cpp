#include "models/emg/cycles.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "tests/models/emg/motions.h"

namespace sinew {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

std::string ErrorOf(const Recording& r, const CycleSettings& settings = {}) {
  const auto found = FindCycles(r.time, r.angle, settings);
  return found ? "" : found.error().message;
}

// Every instant from the first to the last sample is in one cycle or in one that was left out.
void ExpectNothingIsLost(const Recording& r, const CycleFindings& found) {
  std::vector<std::pair<double, double>> stretches;
  for (const MovementCycle& c : found.cycles) stretches.emplace_back(c.begin_s, c.end_s);
  for (const LeftOutCycle& c : found.left_out) stretches.emplace_back(c.begin_s, c.end_s);
  std::sort(stretches.begin(), stretches.end());
  ASSERT_FALSE(stretches.empty());
  std::size_t first = 0;
  std::size_t last = r.time.size() - 1;
  while (!std::isfinite(r.angle[first])) ++first;
  while (!std::isfinite(r.angle[last])) --last;
  EXPECT_EQ(stretches.front().first, r.time[first]);
  EXPECT_EQ(stretches.back().second, r.time[last]);
  for (std::size_t i = 1; i < stretches.size(); ++i)
    EXPECT_EQ(stretches[i].first, stretches[i - 1].second) << i;
}

TEST(CyclesTest, FindsEveryCycleOfADynamometer) {
  for (const double rate : {50.0, 200.0, 2000.0}) {
    for (const double speed : {30.0, 45.0, 60.0, 75.0, 90.0, 120.0}) {
      for (const double noise : {0.0, 0.1}) {
        const Motion motion = ConstantSpeeds(speed, speed, 0.1);
        const Recording r = Record(motion, 0.6, 12.8, rate, noise);  // tops at 0.4, 1.4 .. 12.4 periods
        const auto found = FindCycles(r.time, r.angle, {});
        ASSERT_TRUE(found) << found.error().message;
        ASSERT_EQ(found->cycles.size(), 12U) << rate << " " << speed;
        for (const MovementCycle& c : found->cycles) {
          // 0.1 deg of noise: 6 standard deviations of the turn at the lowest rate.
          const double allowed_s = 0.02 / rate + 6 * noise / speed;
          EXPECT_NEAR(OffTheTop(motion, 0.6, c.begin_s), 0, allowed_s);
          EXPECT_NEAR(c.duration_s(), motion.period_s, 2 * allowed_s);
          EXPECT_NEAR(c.reversal_s - c.begin_s, 0.5 * motion.period_s, 2 * allowed_s);
          // Corners between samples are cut off by up to a sample's step.
          EXPECT_NEAR(c.speed, 90 / motion.period_s, (speed / rate / 45 + 0.02) * speed);
        }
        EXPECT_EQ(CountLeftOut(*found, CycleFault::kIncomplete), 2U);
        EXPECT_EQ(found->left_out.size(), 2U);
        EXPECT_NEAR(found->period_s, motion.period_s, 0.01 * motion.period_s);
        // The corners, up to 20 of 47 samples, add to it.
        EXPECT_NEAR(found->noise, noise, 0.4 * noise + 1e-9);
        EXPECT_THAT(found->doubts, IsEmpty());
        ExpectNothingIsLost(r, *found);
      }
    }
  }
}

TEST(CyclesTest, EitherExtremeBeginsACycle) {
  const Motion motion = ConstantSpeeds(60, 90);
  const Recording r = Record(motion, 0.1, 8.5, 500);
  const auto highest = FindCycles(r.time, r.angle, {});
  CycleSettings settings;
  settings.begins_at = CycleBegin::kLowest;
  const auto lowest = FindCycles(r.time, r.angle, settings);
  ASSERT_TRUE(highest && lowest);
  ASSERT_EQ(highest->cycles.size(), 7U);
  ASSERT_EQ(lowest->cycles.size(), 7U);
  EXPECT_NEAR(highest->cycles[0].begin_s, 0.9 * motion.period_s, 2e-4);
  EXPECT_NEAR(lowest->cycles[0].begin_s, 0.5 * motion.period_s, 2e-4);  // down takes 0.6 of the period
  EXPECT_NEAR(highest->cycles[0].reversal_s, lowest->cycles[1].begin_s, 1e-12);
  // The same movement upside down.
  Recording turned = r;
  for (double& angle : turned.angle) angle = -angle;
  const auto again = FindCycles(turned.time, turned.angle, settings);
  ASSERT_TRUE(again);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_EQ(again->cycles[i].begin_s, highest->cycles[i].begin_s);
    EXPECT_EQ(again->cycles[i].speed, highest->cycles[i].speed);
  }
}

TEST(CyclesTest, UnitsDoNotMatter) {
  const Recording r = Record(ConstantSpeeds(45, 45), 0.3, 6, 200, 0.2);
  Recording scaled = r;
  for (double& angle : scaled.angle) angle *= 0x1p-6;
  const auto one = FindCycles(r.time, r.angle, {});
  const auto other = FindCycles(scaled.time, scaled.angle, {});
  ASSERT_TRUE(one && other);
  ASSERT_EQ(one->cycles.size(), other->cycles.size());
  for (std::size_t i = 0; i < one->cycles.size(); ++i) {
    EXPECT_EQ(one->cycles[i].begin_s, other->cycles[i].begin_s);
    EXPECT_EQ(one->cycles[i].speed, other->cycles[i].speed * 0x1p6);
  }
}

// A recording that begins and ends at a turning point: when it began to turn there is unknown.
TEST(CyclesTest, TheEndsAreIncomplete) {
  const Motion motion = Cosine(1);
  const Recording r = Record(motion, 0, 5.01, 100);
  const auto found = FindCycles(r.time, r.angle, {});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->cycles.size(), 3U);
  EXPECT_EQ(CountLeftOut(*found, CycleFault::kIncomplete), 2U);
  EXPECT_EQ(found->left_out[0].reason,
            "The 1.00 s from 0 to 1.000 s are no complete cycle: the recording begins there.");
  EXPECT_THAT(found->left_out[1].reason, HasSubstr("the recording ends there"));
  ExpectNothingIsLost(r, *found);

  const Recording less = Record(motion, 0.3, 1.6, 100);
  const auto none = FindCycles(less.time, less.angle, {});
  ASSERT_TRUE(none);
  EXPECT_THAT(none->cycles, IsEmpty());
  ASSERT_EQ(none->left_out.size(), 1U);
  EXPECT_EQ(none->left_out[0].reason, "The 1.59 s from 0 to 1.590 s hold no complete cycle.");
  EXPECT_EQ(DescribeCycles(*none)[0], "No cycle was found.");
}

TEST(CyclesTest, CyclesWithGapsAreLeftOut) {
  const Motion motion = Cosine(1);  // tops at 0.5, 1.5 ..
  const Recording whole = Record(motion, 0.5, 12, 200);
  const auto gap = [&](double from_s, double to_s) {
    Recording r = whole;
    for (std::size_t k = 0; k < r.time.size(); ++k)
      if (r.time[k] > from_s && r.time[k] < to_s) r.angle[k] = NAN;
    return r;
  };
  // In the middle of the cycle from 3.5 to 4.5 s: one sample is enough.
  for (const double length_s : {0.006, 0.05, 0.2}) {
    const Recording r = gap(4.1, 4.1 + length_s);
    const auto found = FindCycles(r.time, r.angle, {});
    ASSERT_TRUE(found);
    EXPECT_EQ(found->cycles.size(), 10U) << length_s;
    ASSERT_EQ(CountLeftOut(*found, CycleFault::kGap), 1U);
    EXPECT_NEAR(found->left_out[1].begin_s, 3.5, 1e-3);
    EXPECT_THAT(found->left_out[1].reason, HasSubstr("no angle between 4.100 and"));
    for (const MovementCycle& c : found->cycles) EXPECT_NEAR(c.duration_s(), 1, 1e-4);
    ExpectNothingIsLost(r, *found);
  }
  // At a turning point: its time is spoilt for both cycles.
  const Recording at_turn = gap(4.45, 4.55);
  const auto both = FindCycles(at_turn.time, at_turn.angle, {});
  ASSERT_TRUE(both);
  EXPECT_EQ(both->cycles.size(), 9U);
  EXPECT_EQ(CountLeftOut(*both, CycleFault::kGap), 2U);
  // It hides the turning point altogether.
  const Recording over_turn = gap(4.1, 4.9);
  const auto one = FindCycles(over_turn.time, over_turn.angle, {});
  ASSERT_TRUE(one);
  EXPECT_EQ(one->cycles.size(), 9U);
  EXPECT_EQ(CountLeftOut(*one, CycleFault::kGap), 1U);
  EXPECT_EQ(one->cycles.size() + one->left_out.size(), 12U);
  EXPECT_NEAR(one->median_duration_s, 1, 1e-4);
  // Allowed when asked for; infinite samples are missing ones; a clock that stops is a gap.
  CycleSettings settings;
  settings.longest_gap_s = 0.06;
  Recording infinite = gap(4.1, 4.15);
  for (double& angle : infinite.angle)
    if (std::isnan(angle)) angle = INFINITY;
  EXPECT_EQ(FindCycles(infinite.time, infinite.angle, settings)->cycles.size(), 11U);
  EXPECT_EQ(FindCycles(infinite.time, infinite.angle, {})->cycles.size(), 10U);
  Recording stopped;
  for (std::size_t k = 0; k < whole.time.size(); ++k) {
    if (whole.time[k] > 4.1 && whole.time[k] < 4.2) continue;
    stopped.time.push_back(whole.time[k]);
    stopped.angle.push_back(whole.angle[k]);
  }
  EXPECT_EQ(CountLeftOut(*FindCycles(stopped.time, stopped.angle, {}), CycleFault::kGap), 1U);
  // At the ends there is less of the recording.
  Recording ends = whole;
  std::fill_n(ends.angle.begin(), 20, NAN);
  std::fill_n(ends.angle.end() - 20, 20, NAN);
  const auto inner = FindCycles(ends.time, ends.angle, {});
  ASSERT_TRUE(inner);
  EXPECT_EQ(inner->cycles.size(), 11U);
  ExpectNothingIsLost(ends, *inner);
}

// Cycles of 1 s; one of them takes `share` more.
Recording WithOneSlowCycle(double share) {
  Recording r;
  double phase = 0.5;
  for (int k = 0; phase < 10; ++k) {
    r.time.push_back(0.005 * k);
    r.angle.push_back(20 * std::cos(2 * kPi * phase));
    phase += 0.005 / (phase >= 4 && phase < 5 ? 1 + share : 1);
  }
  return r;
}

TEST(CyclesTest, OneSlowCycleIsLeftOut) {
  const Recording slow = WithOneSlowCycle(0.4);
  const auto found = FindCycles(slow.time, slow.angle, {});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->cycles.size(), 7U);
  ASSERT_EQ(CountLeftOut(*found, CycleFault::kDuration), 1U);
  EXPECT_NEAR(found->left_out[1].begin_s, 3.5, 0.01);
  EXPECT_NEAR(found->left_out[1].end_s, 4.9, 0.01);
  EXPECT_THAT(found->left_out[1].reason,
              HasSubstr("it takes 1.39 s, 39 % more than the median of 1.00 s, more than the 25 % that are "
                        "allowed."));
  EXPECT_EQ(DescribeCycles(*found)[0],
            "7 cycles found, median 1.00 s; left out: 2 incomplete, 0 with gaps, 1 of another duration.");
  ExpectNothingIsLost(slow, *found);

  const Recording slower = WithOneSlowCycle(0.2);
  EXPECT_EQ(FindCycles(slower.time, slower.angle, {})->cycles.size(), 8U);
  CycleSettings strict;
  strict.duration_tolerance = 0.1;
  EXPECT_EQ(FindCycles(slower.time, slower.angle, strict)->cycles.size(), 7U);
}

TEST(CyclesTest, ARestMakesBothCyclesLonger) {
  Recording r;
  const Motion motion = ConstantSpeeds(60, 60);  // 1.5 s
  double phase = 0.5;
  for (int k = 0; phase < 8; ++k) {
    r.time.push_back(0.002 * k);
    r.angle.push_back(motion.angle(std::fmod(phase, 1.0) * 1.5));
    const bool rests = r.time.back() > 5.2 && r.time.back() < 7.2;  // on the way
    if (!rests) phase += 0.002 / 1.5;
  }
  const auto found = FindCycles(r.time, r.angle, {});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->cycles.size(), 5U);
  EXPECT_EQ(CountLeftOut(*found, CycleFault::kDuration), 1U);
}

// As a knee in walking: two high points of almost the same height in a cycle, now the one and now the other
// is higher.
Recording TwoHumps(std::size_t samples, double rate_Hz) {
  Recording r;
  Random random(5);
  std::vector<double> first;
  std::vector<double> second;
  for (int i = 0; i < 200; ++i) {
    first.push_back(-5 + 2 * random.Normal());
    second.push_back(-6 + 2 * random.Normal());
  }
  const auto hump = [](double x) { return std::exp(-0.5 * x * x / (0.07 * 0.07)); };
  for (std::size_t k = 0; k < samples; ++k) {
    const double t = static_cast<double>(k) / rate_Hz;
    const auto cycle = static_cast<std::size_t>(t);
    const double phase = t - std::floor(t);
    r.time.push_back(t);
    r.angle.push_back(-60 + (60 + first[cycle]) * hump(phase - 0.3) +
                      (60 + second[cycle]) * hump(phase - 0.62) + 22 * hump(phase - 0.46));
  }
  return r;
}

TEST(CyclesTest, BeginsAtTheSameOfTwoHighPoints) {
  const Recording r = TwoHumps(4030, 100);
  const auto found = FindCycles(r.time, r.angle, {});
  ASSERT_TRUE(found);
  EXPECT_GT(found->moved, 5U);
  EXPECT_GE(found->cycles.size(), 38U);
  const double at = found->cycles[0].begin_s - std::floor(found->cycles[0].begin_s);
  for (const MovementCycle& c : found->cycles) {
    EXPECT_NEAR(c.duration_s(), 1, 0.03);
    EXPECT_NEAR(c.begin_s - std::floor(c.begin_s), at, 0.03);
  }
  EXPECT_THAT(DescribeCycles(*found)[1], HasSubstr("are not the most extreme one"));
  ExpectNothingIsLost(r, *found);
}

// Two turns of a movement that repeats less often: the doubt is said, and the settings resolve it.
TEST(CyclesTest, ContradictionsAreReported) {
  const Motion motion{2, 0, [](double t) { return 20 * std::cos(2 * kPi * t) + 8 * std::cos(kPi * t); }};
  const Recording r = Record(motion, 0.2, 10, 100);
  const auto doubtful = FindCycles(r.time, r.angle, {});
  ASSERT_TRUE(doubtful);
  EXPECT_NEAR(doubtful->median_duration_s, 1, 0.02);
  EXPECT_NEAR(doubtful->period_s, 2, 0.02);
  ASSERT_EQ(doubtful->doubts.size(), 1U);
  EXPECT_THAT(doubtful->doubts[0], HasSubstr("several high points"));
  CycleSettings settings;
  settings.shortest_s = 1.3;
  const auto whole = FindCycles(r.time, r.angle, settings);
  ASSERT_TRUE(whole);
  EXPECT_GE(whole->cycles.size(), 8U);
  EXPECT_THAT(whole->doubts, IsEmpty());
  for (const MovementCycle& c : whole->cycles) {
    EXPECT_NEAR(c.duration_s(), 2, 1e-3);
    EXPECT_NEAR(OffTheTop(motion, 0.2, c.begin_s), 0, 1e-3);
  }
}

TEST(CyclesTest, RejectsSignalsWithoutMovement) {
  Recording r = Record(Cosine(1), 0.2, 5, 100);
  CycleSettings settings;
  settings.swing = 0.01;
  EXPECT_EQ(ErrorOf(r, settings), "swing 0.01: expected a share of the range from 0.05 to 0.9");
  settings = {};
  settings.duration_tolerance = NAN;
  EXPECT_EQ(ErrorOf(r, settings), "duration tolerance nan: expected more than 0");
  settings = {};
  settings.longest_gap_s = -1;
  EXPECT_EQ(ErrorOf(r, settings), "longest gap -1 s: expected 0 or more");
  settings = {};
  settings.shortest_s = NAN;
  EXPECT_EQ(ErrorOf(r, settings), "shortest cycle nan s: expected 0 or more");
  Recording constant = r;
  std::fill(constant.angle.begin(), constant.angle.end(), 0.3);
  EXPECT_EQ(ErrorOf(constant), "the angle never changes, expected a movement");
  std::fill(constant.angle.begin(), constant.angle.end(), NAN);
  EXPECT_EQ(ErrorOf(constant), "0 of 500 angles are numbers, expected at least 16");
  EXPECT_EQ(ErrorOf({}), "0 of 0 angles are numbers, expected at least 16");
  Random random(1);
  for (double& angle : constant.angle) angle = random.Normal();
  EXPECT_THAT(ErrorOf(constant), HasSubstr("its noise has a standard deviation of"));
  Recording back = r;
  back.time[7] = back.time[6];
  EXPECT_EQ(ErrorOf(back), "time does not increase after sample 6 (t = 0.06000 s)");
  back.time[7] = NAN;
  EXPECT_EQ(ErrorOf(back), "time 7 is nan, expected a finite number");
  back.time.pop_back();
  EXPECT_EQ(ErrorOf(back), "499 times for 500 angles, expected as many");
}

double FromBytes(Random& random) {
  const std::uint64_t bits = (random.Index(1ULL << 32) << 32) | random.Index(1ULL << 32);
  double value = 0;
  std::memcpy(&value, &bits, sizeof(value));
  return value;
}

// Whatever arrives, the outcome is an error or finite cycles in the order of time.
TEST(CyclesTest, RandomInputNeverBreaksAnything) {
  Random random(7);
  int found_some = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    Recording r = Record(ConstantSpeeds(60, 60), random.Uniform(), 6, 50, random.Uniform());
    const auto kind = random.Index(6);
    const auto hits = kind == 0 ? r.angle.size() : random.Index(30);
    for (std::size_t i = 0; i < hits; ++i) {
      const std::size_t k = kind == 0 ? i : random.Index(r.angle.size());
      if (kind <= 1) r.angle[k] = FromBytes(random);
      if (kind == 2) r.angle[k] = NAN;
      if (kind == 3) r.angle[k] = 1000 * random.Normal();
      if (kind == 4) r.time[k] = FromBytes(random);
      if (kind == 5) r.angle[k] = (random.Index(2) == 0 ? 1 : -1) * std::numeric_limits<double>::max();
    }
    CycleSettings settings;
    settings.begins_at = random.Index(2) == 0 ? CycleBegin::kHighest : CycleBegin::kLowest;
    settings.swing = random.Uniform(0.05, 0.9);
    settings.shortest_s = random.Index(2) == 0 ? 0 : random.Uniform();
    const auto found = FindCycles(r.time, r.angle, settings);
    if (!found) {
      EXPECT_NE(found.error().message, "");
      continue;
    }
    found_some += found->cycles.empty() ? 0 : 1;
    double last_s = r.time.front();
    for (const MovementCycle& c : found->cycles) {
      EXPECT_GE(c.begin_s, last_s);
      EXPECT_GT(c.reversal_s, c.begin_s);
      EXPECT_GT(c.end_s, c.reversal_s);
      EXPECT_GE(c.speed, 0);
      last_s = c.end_s;
    }
    EXPECT_FALSE(DescribeCycles(*found).empty());
  }
  EXPECT_GT(found_some, 500);
}

}  // namespace
}  // namespace sinew
