// Strides of measured walking, from joint angles, against heel strikes from the force under the feet.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "base/constants.h"
#include "models/emg/averaged_emg.h"
#include "models/emg/cycle_checks.h"
#include "models/emg/cycles.h"
#include "models/emg/prediction_error.h"

namespace sinew {
namespace {

using Table = std::map<std::string, std::vector<double>>;

Table Read(const std::string& file) {
  std::ifstream in(SINEW_SHARED_DATA "/walking_emg/" + file);
  std::string line;
  while (std::getline(in, line) && line.find("endheader") == std::string::npos) {
  }
  std::getline(in, line);
  std::istringstream header(line);
  std::vector<std::string> names;
  for (std::string name; header >> name;) names.push_back(name);
  Table table;
  while (std::getline(in, line)) {
    std::istringstream row(line);
    for (const std::string& name : names) {
      double value = 0;
      if (row >> value) table[name].push_back(value);
    }
  }
  return table;
}

#define SKIP_WITHOUT_WALKING()                                    \
  if (!std::filesystem::exists(SINEW_SHARED_DATA "/walking_emg")) \
  GTEST_SKIP() << "no " << SINEW_SHARED_DATA << "/walking_emg"

// Times at which the force begins to carry: over 200 N after less than 30 N.
std::vector<double> HeelStrikes(const Table& forces, const std::string& force) {
  std::vector<double> strikes;
  bool loaded = true;
  const auto& values = forces.at(force);
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (!loaded && values[k] > 200) strikes.push_back(forces.at("time")[k]);
    loaded = values[k] > 200 || (loaded && values[k] >= 30);
  }
  return strikes;
}

double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

TEST(WalkingCyclesTest, StridesAreThoseOfTheHeelStrikes) {
  SKIP_WITHOUT_WALKING();
  for (const std::string walk : {"walk36", "walk45"}) {
    const Table angles = Read(walk + "/ik.sto");
    const Table forces = Read(walk + "/XLD.mot");
    const auto strikes = HeelStrikes(forces, "l_ground_force_vy");
    ASSERT_GT(strikes.size(), 50U);
    std::vector<double> strides;
    for (std::size_t i = 1; i < strikes.size(); ++i) strides.push_back(strikes[i] - strikes[i - 1]);
    const double length_s = angles.at("time").back() - angles.at("time").front();
    for (const std::string angle : {"ankle_angle_r", "ankle_angle_l", "knee_angle_r", "knee_angle_l"}) {
      for (const auto begin : {CycleBegin::kLowest, CycleBegin::kHighest}) {
        CycleSettings settings;
        settings.begins_at = begin;
        const auto found = FindCycles(angles.at("time"), angles.at(angle), settings);
        ASSERT_TRUE(found) << found.error().message;
        const bool strongly_autocorrelated = begin == CycleBegin::kHighest && angle[0] == 'a';
        // Both have two incomplete ends, which may hold one beginning more or less.
        EXPECT_NEAR(static_cast<double>(found->cycles.size()), std::floor(length_s / Median(strides)),
                    strongly_autocorrelated ? 3 : 2)
            << walk << " " << angle;
        EXPECT_NEAR(found->period_s, Median(strides), 0.01);
        EXPECT_NEAR(found->median_duration_s, Median(strides), 0.012);
        EXPECT_LE(CountLeftOut(*found, CycleFault::kDuration), strongly_autocorrelated ? 3U : 0U);
        EXPECT_EQ(CountLeftOut(*found, CycleFault::kGap), 0U);
        // Push-off and the knee's turning points come as regularly as the heel strikes.
        if (strongly_autocorrelated) continue;
        for (const MovementCycle& c : found->cycles)
          EXPECT_NEAR(c.duration_s(), found->median_duration_s, 0.09) << walk << " " << angle;
      }
    }
  }
}

TEST(WalkingCyclesTest, ReportsThatTheAnklesHighestPointVaries) {
  SKIP_WITHOUT_WALKING();
  const Table angles = Read("walk36/ik.sto");
  const auto found = FindCycles(angles.at("time"), angles.at("ankle_angle_r"), {});
  ASSERT_TRUE(found);
  ASSERT_EQ(found->doubts.size(), 1U);
  EXPECT_THAT(found->doubts[0], testing::HasSubstr("cycles that begin there would be more alike"));
}

// Each stride between heel strikes contains exactly one push-off.
TEST(WalkingCyclesTest, OnePushOffInEachStride) {
  SKIP_WITHOUT_WALKING();
  for (const std::string walk : {"walk36", "walk45"}) {
    const Table angles = Read(walk + "/ik.sto");
    const auto strikes = HeelStrikes(Read(walk + "/XLD.mot"), "l_ground_force_vy");
    CycleSettings settings;
    settings.begins_at = CycleBegin::kLowest;
    const auto found = FindCycles(angles.at("time"), angles.at("ankle_angle_l"), settings);
    ASSERT_TRUE(found);
    for (std::size_t i = 1; i + 1 < strikes.size(); ++i) {
      const auto inside = std::count_if(
          found->cycles.begin(), found->cycles.end(),
          [&](const MovementCycle& c) { return c.begin_s >= strikes[i - 1] && c.begin_s < strikes[i]; });
      EXPECT_EQ(inside, 1) << walk << " " << strikes[i - 1];
    }
  }
}

// From recordings to predictions: model from most strides of both speeds, tried on the others. Measured
// values, with margin: they fail when the averaging or the cycles are wrong.
TEST(WalkingCyclesTest, PredictsStridesThatWereNotUsed) {
  SKIP_WITHOUT_WALKING();
  const std::vector<std::string> muscles{"soleus_r", "med_gas_r", "lat_gas_r", "tib_ant_r"};
  std::vector<SpeedCycles> used;
  std::vector<SpeedCycles> held_out;
  for (const std::string walk : {"walk36", "walk45"}) {
    Table angles = Read(walk + "/ik.sto");
    const Table emg = Read(walk + "/emgFilt.sto");
    for (double& angle : angles["ankle_angle_r"]) angle *= kPi / 180;
    CycleSettings settings;
    settings.begins_at = CycleBegin::kLowest;
    const auto found = FindCycles(angles["time"], angles["ankle_angle_r"], settings);
    ASSERT_TRUE(found);
    SpeedCycles at;
    for (const MovementCycle& c : found->cycles)
      at.speed += c.speed / static_cast<double>(found->cycles.size());
    at.muscles.resize(muscles.size());
    SpeedCycles other = at;
    for (std::size_t m = 0; m < muscles.size(); ++m) {
      const auto check = CheckMuscle(emg.at("time"), emg.at(muscles[m]), found->cycles, {});
      ASSERT_TRUE(check) << check.error().message;
      EXPECT_FALSE(check->silent);
      EXPECT_GE(CountUsable(*check), found->cycles.size() - 1);
      for (std::size_t i = 0; i < found->cycles.size(); ++i) {
        if (!check->usable[i]) continue;
        const auto warped =
            WarpCycle(emg.at("time"), emg.at(muscles[m]), found->cycles[i].begin_s, found->cycles[i].end_s);
        ASSERT_TRUE(warped) << warped.error().message;
        (i % 4 == 3 ? other : at).muscles[m].push_back(*warped);
      }
    }
    used.push_back(at);
    held_out.push_back(other);
  }
  EXPECT_GT(used[1].speed, 1.1 * used[0].speed);
  const auto model = AveragedEmg::Build(muscles, used, {});
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_TRUE(model->notes().empty());
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    for (const SpeedCycles& at : held_out) {
      std::vector<PredictionError> errors;
      std::size_t within = 0;
      std::size_t samples = 0;
      for (const auto& cycle : at.muscles[m]) {
        std::vector<double> predicted;
        for (std::size_t k = 0; k < cycle.size(); ++k) {
          const double phase = static_cast<double>(k) / static_cast<double>(cycle.size() - 1);
          predicted.push_back(model->At(m, at.speed, phase));
          within += std::abs(cycle[k] - predicted[k]) <= 2 * model->SpreadAt(m, at.speed, phase) ? 1 : 0;
          ++samples;
        }
        errors.push_back(*ComparePrediction(predicted, cycle));
      }
      const ErrorSummary summary = Summarise(errors);
      const std::string which = muscles[m] + (&at == &held_out[0] ? "_walk36" : "_walk45");
      const double coverage = static_cast<double>(within) / static_cast<double>(samples);
      RecordProperty(which, fmt::format("RMSE {:.4f} R2 {:.3f} coverage {:.3f}", summary.rmse,
                                        summary.r_squared, coverage));
      EXPECT_GT(summary.r_squared, 0.7) << which;
      EXPECT_LT(summary.rmse, 0.06) << which;
      EXPECT_GT(coverage, 0.85) << which;  // of 13 strides, which are not independent
    }
  }
}

}  // namespace
}  // namespace sinew
