#include "models/emg/cycle_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "base/random.h"
#include "models/emg/envelope.h"

namespace sinew {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kAngleRate = 200;

// Ten cycles of 1 s from 0.5 s on.
std::vector<MovementCycle> Cycles() {
  std::vector<MovementCycle> cycles;
  for (int i = 0; i < 10; ++i) cycles.push_back({0.5 + i, 1.0 + i, 1.5 + i, 1});
  return cycles;
}

struct Signal {
  std::vector<double> time;
  std::vector<double> values;
};

Signal Bursts() {
  Signal signal;
  for (int k = 0; k <= 11 * kAngleRate; ++k) {
    const double t = k / kAngleRate;
    signal.time.push_back(t);
    signal.values.push_back(0.05 + (0.5 + 0.04 * std::floor(t)) * std::pow(std::sin(kPi * t), 4));
  }
  return signal;
}

MuscleCheck Check(const Signal& signal, const MuscleCheckSettings& settings = {}) {
  return *CheckMuscle(signal.time, signal.values, Cycles(), settings);
}

std::vector<std::size_t> LeftOut(const MuscleCheck& check) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < check.usable.size(); ++i)
    if (!check.usable[i]) out.push_back(i);
  return out;
}

TEST(CycleChecksTest, GoodCyclesHaveNoNotes) {
  const MuscleCheck check = Check(Bursts());
  EXPECT_FALSE(check.silent);
  EXPECT_THAT(check.faults, IsEmpty());
  EXPECT_EQ(CountUsable(check), 10U);
  EXPECT_THAT(DescribeMuscleCheck("soleus_r", Cycles(), check), IsEmpty());
}

TEST(CycleChecksTest, AMuscleWithoutSignalIsFound) {
  Signal signal = Bursts();
  for (const double value : {0.0, 0.3, double(NAN)}) {
    std::fill(signal.values.begin(), signal.values.end(), value);
    const MuscleCheck check = Check(signal);
    EXPECT_TRUE(check.silent) << value;
    EXPECT_EQ(CountUsable(check), 0U);
    EXPECT_THAT(DescribeMuscleCheck("soleus_r", Cycles(), check),
                ElementsAre("soleus_r: no signal in any cycle; it is left out."));
  }
}

TEST(CycleChecksTest, SomeCyclesWithoutSignalAreFound) {
  Signal signal = Bursts();
  for (std::size_t k = 0; k < signal.time.size(); ++k)
    if (signal.time[k] > 3.4 && signal.time[k] < 5.6) signal.values[k] *= 0.01;
  const MuscleCheck check = Check(signal);
  EXPECT_FALSE(check.silent);
  EXPECT_THAT(LeftOut(check), ElementsAre(3, 4));
  EXPECT_THAT(DescribeMuscleCheck("soleus_r", Cycles(), check),
              ElementsAre("soleus_r: 2 of 10 cycles are left out: 2 without signal (first from 3.500 to "
                          "4.500 s)."));
  MuscleCheckSettings settings;
  settings.weakest = 0.005;
  EXPECT_EQ(CountUsable(Check(signal, settings)), 10U);
}

TEST(CycleChecksTest, AClippedEnvelopeIsFound) {
  Signal signal = Bursts();
  for (double& value : signal.values) value = std::min(value, 0.85);  // the bursts from 8.5 s on are higher
  const MuscleCheck check = Check(signal);
  EXPECT_THAT(LeftOut(check), ElementsAre(7, 8, 9));
  for (const MuscleCycleFault& fault : check.faults) {
    EXPECT_EQ(fault.fault, MuscleFault::kSaturated);
    EXPECT_GT(fault.share, 0.02);
    EXPECT_LT(fault.share, 0.25);
  }
  EXPECT_THAT(DescribeMuscleCheck("m", Cycles(), check)[0],
              HasSubstr("3 of 10 cycles are left out: 3 saturated"));
  MuscleCheckSettings settings;
  settings.saturated = 0.5;
  const MuscleCheck tolerated = Check(signal, settings);
  EXPECT_EQ(CountUsable(tolerated), 10U);
  EXPECT_EQ(tolerated.faults.size(), 3U);
  EXPECT_THAT(DescribeMuscleCheck("m", Cycles(), tolerated),
              ElementsAre("m: used all the same: 3 saturated (first from 7.500 to 8.500 s)."));
}

TEST(CycleChecksTest, CyclesWithGapsAreLeftOut) {
  Signal signal = Bursts();
  signal.values[static_cast<std::size_t>(3.0 * kAngleRate)] = NAN;  // in the cycle from 2.5 s
  signal.values[static_cast<std::size_t>(6.5 * kAngleRate)] = NAN;  // an end of two cycles
  signal.values[10] = NAN;                                          // before the first one
  const MuscleCheck check = Check(signal);
  EXPECT_THAT(LeftOut(check), ElementsAre(2, 5, 6));
  for (const MuscleCycleFault& fault : check.faults) EXPECT_EQ(fault.fault, MuscleFault::kGap);
}

TEST(CycleChecksTest, FaultsOfTheRawSignalAreFound) {
  Random random(4);
  std::vector<double> raw;
  for (int k = 0; k <= 11 * 2048; ++k) raw.push_back(random.Normal());
  const auto at = [](double t) { return static_cast<std::ptrdiff_t>(t * 2048); };
  std::fill_n(raw.begin() + at(2.0), 10, 20.0);   // clipped
  std::fill_n(raw.begin() + at(4.0), 300, 0.25);  // frozen
  std::fill_n(raw.begin() + at(6.0), 50, NAN);    // missing
  std::fill_n(raw.begin() + at(8.45), 10, 20.0);  // 0.05 s before a cycle's end
  const RawEmgFaults faults = FindRawEmgFaults(raw, 2048);
  MuscleCheck check = Check(Bursts());
  AddRawFaults(faults, 0, 2048, 0, Cycles(), {}, check);
  EXPECT_THAT(LeftOut(check), ElementsAre(1, 3, 5, 7));
  ASSERT_EQ(check.faults.size(), 4U);
  EXPECT_EQ(check.faults[2].fault, MuscleFault::kFrozen);
  EXPECT_NEAR(check.faults[2].share, 299.0 / 2048, 1e-6);
  EXPECT_THAT(DescribeMuscleCheck("m", Cycles(), check)[0],
              HasSubstr("m: 4 of 10 cycles are left out: 2 saturated (first from 1.500 to 2.500 s), 1 frozen "
                        "(first from 3.500 to 4.500 s), 1 with gaps (first from 5.500 to 6.500 s)."));
  // What the low-pass spreads reaches the next cycle.
  MuscleCheck reached = Check(Bursts());
  AddRawFaults(faults, 0, 2048, UnsettledSeconds({}), Cycles(), {}, reached);
  EXPECT_THAT(LeftOut(reached), ElementsAre(1, 3, 5, 7, 8));
  // A raw signal that starts later than the envelope's clock.
  MuscleCheck later = Check(Bursts());
  AddRawFaults(faults, 1, 2048, 0, Cycles(), {}, later);
  EXPECT_THAT(LeftOut(later), ElementsAre(2, 4, 6, 8));
  MuscleCheck silent = Check(Bursts());
  AddRawFaults(FindRawEmgFaults(std::vector<double>(22529, 0.1), 2048), 0, 2048, 0, Cycles(), {}, silent);
  EXPECT_TRUE(silent.silent);
  EXPECT_EQ(CountUsable(silent), 0U);
}

TEST(CycleChecksTest, RejectsWhatDoesNotFit) {
  const Signal signal = Bursts();
  const auto message = [](const Result<MuscleCheck>& made) { return made ? "" : made.error().message; };
  EXPECT_EQ(message(CheckMuscle(signal.time, {1}, Cycles(), {})),
            "2201 times for 1 values, expected as many");
  EXPECT_EQ(message(CheckMuscle(signal.time, signal.values, {{10.5, 11, 11.5, 1}}, {})),
            "the cycle from 10.50 to 11.50 s is not covered by the samples");
  EXPECT_NE(message(CheckMuscle({}, {}, Cycles(), {})), "");
  MuscleCheckSettings settings;
  settings.weakest = 1;
  EXPECT_EQ(message(CheckMuscle(signal.time, signal.values, Cycles(), settings)),
            "weakest 1: expected a share from 0 to below 1");
  settings = {};
  settings.frozen = NAN;
  EXPECT_EQ(message(CheckMuscle(signal.time, signal.values, Cycles(), settings)),
            "frozen nan: expected a share from 0 to 1");
  EXPECT_TRUE(CheckMuscle(signal.time, signal.values, {}, {}));
}

}  // namespace
}  // namespace sinew
