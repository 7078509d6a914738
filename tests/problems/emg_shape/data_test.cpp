#include "problems/emg_shape/data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/identify/support/error_of.h"
#include "tests/problems/emg_shape/emg_shape_study.h"

namespace sinew {
namespace {

using testing::Contains;
using testing::HasSubstr;

Grid& EmgOf(Dataset& data, const std::string& trial) {
  return data.trials.at(trial).grids.at("excitations");
}

const Block& BlockOf(const EmgShapeData& data, const std::string& trial, const std::string& muscle) {
  for (const Block& block : data.layout) {
    if (block.trial == trial && block.channel == muscle) return block;
  }
  throw std::invalid_argument(trial);
}

TEST(EmgShapeData, CyclesAndSpeedsOfTheStudy) {
  const auto data = PrepareEmgShapeData(EmgStudy(), EmgSettings());
  ASSERT_TRUE(data) << data.error().message;
  ASSERT_EQ(data->speeds.size(), 3U);
  EXPECT_EQ(data->trained_speeds(), 3);
  EXPECT_NEAR(data->reference.speed, 75 * M_PI / 180, 1e-12) << "the middle of 45, 75, 120";
  for (const EmgShapeTrial& trial : data->trials) {
    EXPECT_EQ(trial.cycles.size(), trial.role == BlockRole::kTrain ? 5U : 2U) << trial.name;
    for (std::size_t i = 0; i < trial.time.size(); ++i) {
      ASSERT_GE(trial.phase[i], -0.6);
      ASSERT_LE(trial.phase[i], 1.6);
    }
  }
  // Compared samples come at 25 Hz; held-out trials are predicted at every sample.
  const Block& train = BlockOf(*data, "train_075", "lat_gas_r");
  EXPECT_NEAR(train.prediction_time[1] - train.prediction_time[0], 0.04, 1e-12);
  const Block& held_out = BlockOf(*data, "validate_075", "lat_gas_r");
  EXPECT_NEAR(held_out.prediction_time[1] - held_out.prediction_time[0], 0.005, 1e-12);
  EXPECT_NEAR(held_out.prediction_time[static_cast<std::size_t>(held_out.sample[1])] -
                  held_out.prediction_time[static_cast<std::size_t>(held_out.sample[0])],
              0.04, 1e-12);
}

TEST(EmgShapeData, TheScatterOfCyclesIsFound) {
  const auto calm =
      PrepareEmgShapeData(EmgStudy({{"subject", 3}, {"noisy", 0}, {"train", 40}}), EmgSettings());
  ASSERT_TRUE(calm);
  // Person 3 as drawn: gains scatter by 0.15 to 0.22, timing by 1.2 to 2 %, its own part half as much again.
  for (const EmgMuscle& muscle : calm->muscles) {
    EXPECT_GT(muscle.gain.total, 0.12) << muscle.name;
    EXPECT_LT(muscle.gain.total, 0.30) << muscle.name;
    EXPECT_GT(muscle.timing.total, 0.010) << muscle.name;
    EXPECT_LT(muscle.timing.total, 0.030) << muscle.name;
  }
}

// Every bit of the EMG is some burst's, and no bit is two bursts'.
TEST(EmgShapeData, BurstsShareTheEmg) {
  const auto data = PrepareEmgShapeData(EmgStudy({{"subject", 3}, {"noisy", 0}}), EmgSettings());
  ASSERT_TRUE(data);
  for (const EmgShapeTrial& trial : data->trials) {
    for (std::size_t m = 0; m < data->muscles.size(); ++m) {
      if (trial.role != BlockRole::kTrain) {
        EXPECT_TRUE(trial.windows[m].empty());
        continue;
      }
      ASSERT_GE(trial.windows[m].size(), trial.cycles.size());
      for (std::size_t i = 0; i < trial.time.size(); ++i) {
        const double place = trial.cycle[i] + trial.phase[i];
        double shares = 0;
        for (const EmgWindow& window : trial.windows[m]) {
          const double share = window.ShareAt(place).value;
          const bool inside = window.first <= static_cast<int>(i) && static_cast<int>(i) < window.end;
          EXPECT_TRUE(inside || share == 0);
          shares += share;
        }
        EXPECT_NEAR(shares, 1, 1e-9) << trial.name << " at " << place;
      }
    }
  }
}

// What an electrode may hear of the others is known where they were measured and something was learnt of
// them.
TEST(EmgShapeData, OthersAreKnownWhereTheyWereMeasured) {
  Dataset data = EmgStudy({{"subject", 3}, {"noisy", 0}, {"train", 12}});
  data.trials.at("train_075").grids.at("excitations").channels.erase("med_gas_r");
  const auto prepared = PrepareEmgShapeData(data, EmgSettings());
  ASSERT_TRUE(prepared) << prepared.error().message;
  ASSERT_EQ(prepared->others_shape.size(), prepared->muscles.size());
  for (std::size_t m = 0; m < prepared->muscles.size(); ++m) {
    for (const EmgShapeTrial& trial : prepared->trials) {
      if (trial.name == "train_075") {
        EXPECT_TRUE(trial.others[m].empty());
        continue;
      }
      ASSERT_EQ(trial.others[m].size(), trial.time.size());
      // Made up without noise: it is the mean of what the others' channels hold, but for the shape's error.
      double largest = 0;
      double sum = 0;
      double count = 0;
      for (std::size_t i = 0; i < trial.time.size(); ++i) {
        double others = 0;
        for (std::size_t o = 0; o < prepared->muscles.size(); ++o) {
          const Block& block = prepared->layout[static_cast<std::size_t>(trial.first_block) + o];
          const auto at = std::find(block.sample.begin(), block.sample.end(), static_cast<int>(i));
          if (at == block.sample.end()) others = NAN;
          if (o != m && std::isfinite(others))
            others += block.measured[static_cast<std::size_t>(at - block.sample.begin())] /
                      static_cast<double>(prepared->muscles.size() - 1);
        }
        if (!std::isfinite(others)) continue;
        largest = std::max(largest, others);
        sum += std::abs(trial.others[m][i] - others);
        count += 1;
      }
      EXPECT_LT(sum / count, 0.02 * largest) << trial.name;
    }
  }
  EmgShapeSettings settings = EmgSettings();
  settings.reference = prepared->reference;
  for (const EmgMuscle& muscle : prepared->muscles) settings.muscles.push_back(muscle.name);
  for (auto& [name, trial] : data.trials) trial.role = Role::kValidate;
  const auto elsewhere = PrepareEmgShapeData(data, settings);
  ASSERT_TRUE(elsewhere) << elsewhere.error().message;
  for (const EmgShapeTrial& trial : elsewhere->trials) {
    for (const auto& others : trial.others) EXPECT_TRUE(others.empty()) << trial.name;
  }
}

TEST(EmgShapeData, AnAngleWithDropoutsLosesThoseCycles) {
  Dataset data = EmgStudy();
  Grid& motion = data.trials.at("train_075").grids.at("motion");
  for (std::size_t i = 0; i < motion.time.size(); ++i) {
    if (motion.time[i] > 1.8 && motion.time[i] < 1.9) motion.channels.at("ankle_angle_r").values[i] = NAN;
  }
  const auto prepared = PrepareEmgShapeData(data, EmgSettings());
  ASSERT_TRUE(prepared) << prepared.error().message;
  EXPECT_THAT(prepared->notes, Contains(HasSubstr("trial 'train_075': 4 cycles found")));
  const Block& block = BlockOf(*prepared, "train_075", "lat_gas_r");
  for (const int i : block.sample) {
    const double t = block.prediction_time[static_cast<std::size_t>(i)];
    EXPECT_FALSE(t > 1.8 && t < 1.9) << t;
  }
}

TEST(EmgShapeData, AMuscleWithoutSignalIsLeftOutAndSaid) {
  Dataset data = EmgStudy();
  for (const char* trial : {"train_045", "train_075", "train_120"}) {
    auto& values = EmgOf(data, trial).channels.at("med_gas_r").values;
    std::fill(values.begin(), values.end(), 0.0);
  }
  const auto prepared = PrepareEmgShapeData(data, EmgSettings());
  ASSERT_TRUE(prepared);
  ASSERT_EQ(prepared->muscles.size(), 1U);
  EXPECT_THAT(prepared->notes, Contains(HasSubstr("med_gas_r: no signal in any cycle; it is left out.")));
  EXPECT_THAT(prepared->notes,
              Contains("med_gas_r is left out: no training trial has a usable signal of it"));
}

TEST(EmgShapeData, ClippedRawEmgLeavesItsCycleOut) {
  Dataset data = EmgStudy({{"raw", 1}});
  Grid& emg = data.trials.at("train_075").grids.at("emg");
  auto& raw = emg.channels.at("lat_gas_r").values;
  const double most = *std::max_element(raw.begin(), raw.end());
  for (std::size_t i = 0; i < raw.size(); ++i) {
    if (emg.time[i] > 2.0 && emg.time[i] < 2.02) raw[i] = most;
  }
  const auto prepared = PrepareEmgShapeData(data, EmgSettings());
  ASSERT_TRUE(prepared);
  EXPECT_THAT(prepared->notes,
              Contains(HasSubstr("trial 'train_075': lat_gas_r: 1 of 5 cycles are left out")));
  const Block& block = BlockOf(*prepared, "train_075", "lat_gas_r");
  for (const int i : block.sample) {
    const double t = block.prediction_time[static_cast<std::size_t>(i)];
    EXPECT_FALSE(t > 2.0 && t < 2.02) << t;
  }
}

TEST(EmgShapeData, ASpeedWithOneCycleIsLeftOut) {
  Dataset data = EmgStudy({{"train", 1}});
  data.trials["train_120"] = EmgStudy({{"train", 4}}).trials.at("train_120");
  const auto prepared = PrepareEmgShapeData(data, EmgSettings());
  ASSERT_TRUE(prepared) << prepared.error().message;
  EXPECT_EQ(prepared->trained_speeds(), 1);
  EXPECT_THAT(prepared->notes, Contains("trial 'train_075' is left out: 1 cycle, expected at least 2"));
}

TEST(EmgShapeData, WhatCannotBeUsedIsAnError) {
  const Dataset good = EmgStudy();
  EXPECT_THAT(ErrorOf(PrepareEmgShapeData(good, EmgSettings(", muscles: [unmeasured]"))),
              HasSubstr("no training trial has a usable signal of any muscle"));
  EXPECT_THAT(ErrorOf(PrepareEmgShapeData(good, EmgSettings(", hold_out: [train_75]"))),
              HasSubstr("hold_out: there is no trial 'train_75'; did you mean 'train_075'?"));
  Dataset data = good;
  data.trials.at("train_075").grids.erase("motion");
  EXPECT_THAT(ErrorOf(PrepareEmgShapeData(data, EmgSettings())),
              HasSubstr("trial 'train_075': has no channel 'ankle_angle_r'"));
  data = good;
  data.trials.at("train_075").grids.erase("excitations");
  EXPECT_THAT(ErrorOf(PrepareEmgShapeData(data, EmgSettings())), HasSubstr("has no grid 'excitations'"));
  data = good;
  EmgOf(data, "train_075").channels.at("lat_gas_r").unit = "V";
  EXPECT_THAT(ErrorOf(PrepareEmgShapeData(data, EmgSettings())), HasSubstr("has the unit V, expected 1"));
  data = good;
  for (auto& [name, trial] : data.trials) trial.role = Role::kValidate;
  EXPECT_THAT(ErrorOf(PrepareEmgShapeData(data, EmgSettings())), HasSubstr("there is no training trial"));
}

}  // namespace
}  // namespace sinew
