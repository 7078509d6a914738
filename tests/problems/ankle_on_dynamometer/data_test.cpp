#include "problems/ankle_on_dynamometer/data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/problems/ankle_on_dynamometer/ankle_bench.h"

namespace sinew {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

std::string DataError(const Dataset& data, const AnkleSettings& settings = AnkleBenchSettings()) {
  const auto prepared = PrepareAnkleData(data, settings, 0);
  return prepared ? "" : prepared.error().message;
}

TEST(AnkleDataTest, TrialsAreWhatTheirConditionsSay) {
  const auto prepared = PrepareAnkleData(AnkleBenchData(), AnkleBenchSettings(), 0);
  ASSERT_TRUE(prepared) << prepared.error().message;
  ASSERT_EQ(prepared->trials.size(), 3U);
  EXPECT_EQ(prepared->trials[0].task, AnkleTask::kAttachmentAlone);
  EXPECT_EQ(prepared->trials[1].task, AnkleTask::kPassive);
  EXPECT_EQ(prepared->trials[2].task, AnkleTask::kActive);
  EXPECT_EQ(prepared->trials[0].blocks.size(), 1U);
  EXPECT_EQ(prepared->trials[1].blocks.size(), 2U);
  EXPECT_TRUE(prepared->trials[1].excitations.empty());
  EXPECT_EQ(prepared->trials[2].excitations.size(), 2U);
  // A step of 5 ms twice between samples 10 ms apart, three stages each.
  EXPECT_EQ(prepared->trials[2].steps.size(), 200U);
  EXPECT_EQ(prepared->trials[2].stage_times.size(), 601U);
}

TEST(AnkleDataTest, NamesWhatIsMissing) {
  Dataset data = AnkleBenchData();
  data.trials["working"].grids.erase("excitations");
  EXPECT_EQ(DataError(data),
            "trial 'working' has no grid 'excitations'; a trial of a person who relaxes has the condition "
            "passive = 1");
  data = AnkleBenchData();
  auto& excitations = data.trials["working"].grids["excitations"];
  excitations.channels["soleus_l"] = excitations.channels["soleus_r"];
  excitations.channels.erase("soleus_r");
  EXPECT_EQ(DataError(data),
            "trial 'working': grid 'excitations' has no channel 'soleus_r'; did you mean 'soleus_l'?");
  data = AnkleBenchData();
  MachineGrid(data, "relaxed").channels.erase("machine_angle");
  EXPECT_EQ(DataError(data), "trial 'relaxed' has no channel machine_angle");
  data = AnkleBenchData();
  MachineGrid(data, "relaxed").channels.erase("machine_torque");
  EXPECT_EQ(DataError(data), "trial 'relaxed' has no channel machine_torque");
  data.trials.clear();
  EXPECT_THAT(DataError(data), StartsWith("no trial has the channels machine_angle and machine_torque"));
  data = AnkleBenchData();
  for (double& value : MachineGrid(data, "alone").channels["machine_torque"].values) value = NAN;
  EXPECT_EQ(DataError(data), "trial 'alone': machine_torque has no value");
}

TEST(AnkleDataTest, UnitsAreChecked) {
  const auto error = [](const char* channel, const char* unit) {
    Dataset data = AnkleBenchData();
    MachineGrid(data, "relaxed").channels[channel].unit = unit;
    return DataError(data);
  };
  EXPECT_EQ(error("machine_angle", "m"), "trial 'relaxed': machine_angle is in m, expected rad");
  EXPECT_EQ(error("machine_torque", "V"), "trial 'relaxed': machine_torque is in V, expected N*m");
  EXPECT_EQ(error("ankle_angle", "m"), "trial 'relaxed': ankle_angle is in m, expected rad");
  Dataset data = AnkleBenchData();
  data.trials["working"].grids["excitations"].channels["tib_ant_r"].unit = "V";
  EXPECT_EQ(DataError(data), "trial 'working': tib_ant_r is in V, expected 1");
}

TEST(AnkleDataTest, AGapInAnInputIsAnErrorAndInAMeasurementIsLeftOut) {
  Dataset data = AnkleBenchData();
  MachineGrid(data, "alone").channels["machine_angle"].values[7] = NAN;
  EXPECT_THAT(DataError(data), StartsWith("trial 'alone': machine_angle has a gap at t = 0.07 s"));
  data = AnkleBenchData();
  data.trials["working"].grids["excitations"].channels["soleus_r"].values[42] = NAN;
  EXPECT_THAT(DataError(data), StartsWith("trial 'working': soleus_r has a gap at t = 0.42 s"));
  data = AnkleBenchData();
  MachineGrid(data, "alone").channels["machine_torque"].values[7] = NAN;
  const auto prepared = PrepareAnkleData(data, AnkleBenchSettings(), 0);
  ASSERT_TRUE(prepared) << prepared.error().message;
  EXPECT_EQ(prepared->layout[0].samples(), 100);
  EXPECT_EQ(prepared->layout[0].predictions(), 101);
}

TEST(AnkleDataTest, TimesAreChecked) {
  Dataset data = AnkleBenchData();
  Grid late;
  late.time = {0.5, 1.2};
  late.channels["machine_torque"] = {"N*m", ChannelKind::kMeasured, {}, {1, 2}};
  MachineGrid(data, "alone").channels.erase("machine_torque");
  data.trials["alone"].grids["torque"] = late;
  EXPECT_EQ(DataError(data),
            "trial 'alone': machine_torque is measured at t = 1.2 s, but machine_angle only from 0 to 1 s");
  // A filter needs samples at one rate.
  data = AnkleBenchData();
  Grid& machine = MachineGrid(data, "alone");
  for (std::size_t i = 60; i < machine.time.size(); ++i) machine.time[i] += 0.5;
  EXPECT_THAT(DataError(data), StartsWith("trial 'alone': machine_angle: "));
}

TEST(AnkleDataTest, ExcitationsOutsideOfTheirRangeAreCutAndSaid) {
  Dataset data = AnkleBenchData();
  data.trials["working"].grids["excitations"].channels["soleus_r"].values[5] = 1.3;
  const auto prepared = PrepareAnkleData(data, AnkleBenchSettings(), 0);
  ASSERT_TRUE(prepared) << prepared.error().message;
  EXPECT_EQ(prepared->trials[2].excitations[0][5], 1);
  EXPECT_THAT(prepared->notes, ElementsAre(HasSubstr("trial 'working': excitations outside of 0..1")));
}

TEST(AnkleDataTest, TasksWithoutATrialAreSaid) {
  const auto notes = [](const std::string& trial, bool held_out) {
    Dataset data = AnkleBenchData();
    if (held_out) {
      data.trials[trial].role = Role::kValidate;
    } else {
      data.trials.erase(trial);
    }
    return PrepareAnkleData(data, AnkleBenchSettings(), 0)->notes;
  };
  for (const bool held_out : {false, true}) {
    EXPECT_THAT(notes("alone", held_out), ElementsAre(StartsWith("no trial of the attachment alone")));
    EXPECT_THAT(notes("relaxed", held_out), ElementsAre(StartsWith("no trial of a person who relaxes")));
    EXPECT_THAT(notes("working", held_out), ElementsAre(StartsWith("no trial of active muscles")));
  }
}

TEST(AnkleDataTest, AnAmplifierThatWasOffIsSaid) {
  Dataset data = AnkleBenchData();
  Grid silent = data.trials["working"].grids["excitations"];
  for (auto& [name, channel] : silent.channels) {
    for (double& value : channel.values) value = 0.001;
  }
  data.trials["relaxed"].grids["excitations"] = silent;
  const auto prepared = PrepareAnkleData(data, AnkleBenchSettings(), 0);
  ASSERT_TRUE(prepared) << prepared.error().message;
  EXPECT_THAT(prepared->notes,
              ElementsAre(HasSubstr("of soleus_r stays below 0.001"), HasSubstr("of tib_ant_r")));
  EXPECT_THAT(prepared->notes[0], HasSubstr("was its amplifier off?"));
  // As quiet as the electrode is at rest: nothing to say.
  for (auto& [name, channel] : silent.channels) {
    for (double& value : channel.values) value = 0.02;
  }
  data.trials["relaxed"].grids["excitations"] = silent;
  EXPECT_TRUE(PrepareAnkleData(data, AnkleBenchSettings(), 0)->notes.empty());
}

TEST(AnkleDataTest, WeightsAreStatedNoiseOrSpread) {
  Dataset data = AnkleBenchData();
  auto prepared = PrepareAnkleData(data, AnkleBenchSettings(), 0);
  EXPECT_DOUBLE_EQ(prepared->layout[0].weight, 1 / 0.3);
  // One trial without a stated level: the channel's spread for all of them.
  MachineGrid(data, "alone").channels["machine_torque"].sigma.reset();
  prepared = PrepareAnkleData(data, AnkleBenchSettings(), 0);
  EXPECT_NEAR(prepared->layout[0].weight, std::sqrt(2) / 3, 0.1);
  EXPECT_EQ(prepared->layout[0].weight, prepared->layout[1].weight);
}

TEST(AnkleDataTest, ARateMakesMedians) {
  AnkleSettings settings = AnkleBenchSettings();
  settings.rate = 20;
  Dataset data = AnkleBenchData();
  auto& torque = MachineGrid(data, "alone").channels["machine_torque"];
  const double median = torque.values[12];
  torque.values[11] = 500;  // one sample that jumps
  auto prepared = PrepareAnkleData(data, settings, 0);
  ASSERT_TRUE(prepared) << prepared.error().message;
  const Block& block = prepared->layout[0];
  // 101 samples in bins of five, the last one alone is left out.
  ASSERT_EQ(block.samples(), 20);
  EXPECT_NEAR(block.prediction_time[0], 0.02, 1e-12);
  EXPECT_NEAR(block.prediction_time[2], 0.12, 1e-12);
  EXPECT_NEAR(block.measured[0], 3 * std::sin(5 * 0.02), 1e-12);
  EXPECT_NEAR(block.measured[2], 3 * std::sin(5 * 0.13), 1e-12);
  EXPECT_NE(block.measured[2], median);
  EXPECT_NEAR(*block.sigma, 0.3 * 1.25 / std::sqrt(5.0), 1e-12);
  // A bin that has mostly gaps is one.
  for (int i = 10; i < 13; ++i) torque.values[static_cast<std::size_t>(i)] = NAN;
  prepared = PrepareAnkleData(data, settings, 0);
  ASSERT_TRUE(prepared) << prepared.error().message;
  EXPECT_EQ(prepared->layout[0].samples(), 19);
  // Recorded more slowly than that: as it is.
  settings.rate = 80;
  prepared = PrepareAnkleData(AnkleBenchData(), settings, 0);
  EXPECT_EQ(prepared->layout[0].samples(), 101);
  EXPECT_EQ(*prepared->layout[0].sigma, 0.3);
}

TEST(AnkleDataTest, AMarginPredictsBeyondTheSamples) {
  Dataset data = AnkleBenchData();
  Grid torque;
  for (int i = 20; i <= 80; ++i) torque.time.push_back(0.01 * i);
  torque.channels["machine_torque"] = {"N*m", ChannelKind::kMeasured, {}, std::vector<double>(61, 1.0)};
  MachineGrid(data, "alone").channels.erase("machine_torque");
  data.trials["alone"].grids["torque"] = torque;
  const auto prepared = PrepareAnkleData(data, AnkleBenchSettings(), 0.1);
  ASSERT_TRUE(prepared) << prepared.error().message;
  const Block& block = prepared->layout[0];
  EXPECT_NEAR(block.prediction_time.front(), 0.1, 1e-9);
  EXPECT_NEAR(block.prediction_time.back(), 0.9, 1e-9);
  EXPECT_EQ(block.samples(), 61);
  EXPECT_NEAR(block.prediction_time[static_cast<std::size_t>(block.sample.front())], 0.2, 1e-9);
}

}  // namespace
}  // namespace sinew
