// The readers on files that laboratories and other programs wrote.
#include <algorithm>
#include <cmath>

#include "base/constants.h"
#include "datasets/cut.h"
#include "datasets/dataset_hash.h"
#include "datasets/io/dataset_file.h"
#include "datasets/io/import.h"
#include "datasets/io/trc_file.h"
#include "tests/datasets/support.h"

namespace sinew {
namespace {

using testing::HasSubstr;

constexpr double kTime = 1e-12;  // s; decimal fractions in binary

std::string Shared(const std::string& path) {
  return std::string(SINEW_SHARED_DATA) + "/" + path;
}

#define SKIP_WITHOUT(path) \
  if (!std::filesystem::exists(Shared(path))) GTEST_SKIP() << "no " << Shared(path)

TEST(SharedData, GaitMarkersForcesAndAnglesBecomeOneTrial) {
  SKIP_WITHOUT("gait_subject01");
  const std::string folder = Shared("gait_subject01/");
  ImportOptions options;
  options.trial = "walk";
  const auto loads = ReadExternalLoads(folder + "ExperimentalData_subject01_walk_grf.xml");
  ASSERT_TRUE(loads) << ErrorOf(loads);
  ASSERT_EQ(loads->size(), 2U);
  EXPECT_EQ((*loads)[1].applied_to_body, "calcn_l");
  options.external_loads = *loads;
  Dataset dataset;
  std::vector<std::string> notes;
  ASSERT_EQ(
      ErrorOf(ImportFiles(
          {folder + "ExperimentalData_subject01_walk.trc", folder + "ExperimentalData_subject01_walk_grf.mot",
           folder + "IK_subject01_walk_IK.mot", folder + "Gait10dof18musc_subject01.osim"},
          options, dataset, notes)),
      "");
  const Trial& walk = dataset.trials.at("walk");
  const Grid& markers = walk.grids.at("markers");
  EXPECT_EQ(markers.channels.size(), 3U * 41);
  ASSERT_EQ(markers.time.size(), 151U);
  for (std::size_t i = 0; i < 151; ++i) ASSERT_NEAR(markers.time[i], static_cast<double>(i) / 60, kTime);
  EXPECT_EQ(markers.channels.at("R.ASIS_y").values[2], 1051.77124e-3);

  const Grid& forces = walk.grids.at("forces");
  ASSERT_EQ(forces.time.size(), 1501U);
  for (std::size_t i = 0; i < 1501; ++i) ASSERT_NEAR(forces.time[i], static_cast<double>(i) / 600, kTime);
  EXPECT_EQ(forces.channels.at("right_force_y").values[1], 743.0973413);
  EXPECT_EQ(forces.channels.at("left_force_y").values[0], 20.49185173);
  EXPECT_EQ(forces.channels.at("left_cop_x").values[0], 0.81009656);
  EXPECT_EQ(forces.channels.at("right_moment_y").unit, "N*m");

  const Grid& angles = walk.grids.at("coordinates");
  EXPECT_EQ(angles.time, markers.time);
  EXPECT_DOUBLE_EQ(angles.channels.at("pelvis_tilt").values[0], 10.32995988 * kPi / 180);
  EXPECT_EQ(angles.channels.at("pelvis_ty").values[0], 1.01790250);
  EXPECT_THAT(notes, testing::ElementsAre(HasSubstr("rebuilt at 60 Hz from 0 s"),
                                          HasSubstr("rebuilt at 600 Hz from 0 s"),
                                          HasSubstr("rebuilt at 60 Hz from 0 s")));

  ASSERT_EQ(ErrorOf(CutTrial(dataset, {"walk", 0.6, 1.3, "stance"})), "");
  const TemporaryFolder temporary;
  ASSERT_EQ(ErrorOf(WriteDataset(temporary.Path("gait.h5"), dataset)), "");
  const auto read = ReadDataset(temporary.Path("gait.h5"));
  ASSERT_TRUE(read) << ErrorOf(read);
  EXPECT_EQ(DatasetHash(*read), DatasetHash(dataset));
}

struct Expected {
  const char* path;
  std::size_t rows;
  std::size_t columns;
  double rate_Hz;
  const char* grid;
  const char* channel;
  const char* unit;
};

TEST(SharedData, EveryDialectOfStorage) {
  SKIP_WITHOUT("walking_emg");
  const Expected files[] = {
      {"gait_subject01/Results_subject01_walk_ID.sto", 151, 10, 60.000024, "Results_subject01_walk_ID",
       "ankle_angle_r_moment", "N*m"},
      {"walking_emg/walk36/emgFilt.sto", 6097, 9, 100, "emgFilt", "soleus_r", "1"},
      {"walking_emg/walk45/emgFilt.sto", 5904, 9, 100, "emgFilt", "tib_ant_r", "1"},
      {"walking_emg/walk36/ik.sto", 6097, 23, 100, "coordinates", "ankle_angle_r", "rad"},
      {"walking_emg/walk45/id.sto", 5904, 23, 100, "id", "ankle_angle_r_moment", "N*m"},
      {"walking_emg/walk36/XLD.mot", 6097, 18, 100, "forces", "l_ground_force_vy", "N"},
      {"muscle_lengths_opensim/subject_walk_armless_coordinates.mot", 238, 39, 100, "coordinates",
       "pelvis_tx", "m"},
      {"muscle_lengths_opensim/walk_gait1018_state_reference.mot", 151, 10, 60, "coordinates",
       "hip_flexion_r", "rad"},
      {"muscle_lengths_opensim/std_testGeometryPathWrapping_walk_gait1018_muscle_lengths.sto", 151, 18, 60,
       "std_testGeometryPathWrapping_walk_gait1018_muscle_lengths", "bifemsh_r_length", "m"},
      {"ceinms_example/trial1/emg.mot", 1261, 11, 1000, "emg", "soleus_r", "1"},
      {"ceinms_example/trial1/Length.sto", 121, 11, 100, "Length", "soleus_r", "m"},
      {"ceinms_example/trial1/MomentArm_ankle_angle_r.sto", 121, 4, 100, "MomentArm_ankle_angle_r",
       "soleus_r", "m"},
      {"ceinms_example/trial2/id.sto", 121, 2, 100, "id", "knee_angle_r_moment", "N*m"},
      {"ceinms_example/reference_output/out_true_stiff_1/Torques.sto", 121, 2, 100, "Torques", "knee_angle_r",
       "1"},
      {"ceinms_example/reference_output/out_true_equilibriumElastic_3/MuscleForces.sto", 121, 11, 100,
       "MuscleForces", "soleus_r", "1"},
  };
  constexpr double kRate = 1e-7;  // relative: the inverse dynamics have times of 8 decimals
  for (const Expected& file : files) {
    Dataset dataset;
    std::vector<std::string> notes;
    ImportOptions options;
    options.trial = "t";
    ASSERT_EQ(ErrorOf(ImportFile(Shared(file.path), options, dataset, notes)), "");
    ASSERT_EQ(dataset.trials.at("t").grids.count(file.grid), 1U) << file.path;
    const Grid& grid = dataset.trials.at("t").grids.at(file.grid);
    EXPECT_EQ(grid.time.size(), file.rows) << file.path;
    EXPECT_EQ(grid.channels.size(), file.columns) << file.path;
    const double rate = static_cast<double>(file.rows - 1) / (grid.time.back() - grid.time.front());
    EXPECT_NEAR(rate / file.rate_Hz, 1, kRate) << file.path;
    ASSERT_EQ(grid.channels.count(file.channel), 1U) << file.path;
    EXPECT_EQ(grid.channels.at(file.channel).unit, file.unit) << file.path;
  }
}

TEST(SharedData, ServoLogsComeInThroughAMap) {
  SKIP_WITHOUT("servo_pendulum");
  ImportOptions options;
  options.trial = "t";
  const auto map = ParseImportMap(
      "time: {column: t_s, unit: s}\nchannels: {position: {column: position_rad, unit: rad}, "
      "reference: {column: goal_position_rad, unit: rad, kind: input}}\n",
      "map.yaml");
  ASSERT_TRUE(map) << ErrorOf(map);
  options.map = *map;
  const std::pair<const char*, double> files[] = {{"servo_pendulum/xl330/2026-01-15_10h28m10.csv", 0.005},
                                                  {"servo_pendulum/sts3250/2024-10-26_12h23m27.csv", 0}};
  for (const auto& [path, step] : files) {
    Dataset dataset;
    std::vector<std::string> notes;
    ASSERT_EQ(ErrorOf(ImportFile(Shared(path), options, dataset, notes)), "");
    ASSERT_EQ(notes.size(), 1U) << path;  // jittered times are unchanged; notes concern other columns only
    EXPECT_THAT(notes[0], HasSubstr("left out")) << path;
    const Grid& grid = dataset.trials.at("t").grids.begin()->second;
    if (step > 0) {
      EXPECT_NEAR(grid.time[1] - grid.time[0], step, kTime);
    }
  }
}

TEST(SharedData, EveryRecordingOfTheDynamometerComesInWithItsMap) {
  SKIP_WITHOUT("dynamometer_ankle");
  const std::filesystem::path folder = Shared("dynamometer_ankle");
  const std::string maps = std::string(SINEW_SOURCE_DIR) + "/docs/examples/dynamometer_ankle/";
  int recordings = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".mat") continue;
    const bool passive = entry.path().filename().string().rfind("Pas", 0) == 0;
    ImportOptions options;
    options.trial = "trial";
    const auto map = ReadImportMap(maps + (passive ? "passive.yaml" : "contraction.yaml"));
    ASSERT_TRUE(map) << ErrorOf(map);
    options.map = *map;
    std::vector<std::string> files = {entry.path().string()};
    if (!passive) files.push_back((folder / "fascicles" / entry.path().filename()).string());
    Dataset dataset;
    std::vector<std::string> notes;
    ASSERT_EQ(ErrorOf(ImportFiles(files, options, dataset, notes)), "");
    const Trial& trial = dataset.trials.at("trial");
    const auto torque = trial.Find("machine_torque");
    ASSERT_EQ(torque.grid->time.size(), 34000U);
    EXPECT_NEAR(torque.grid->time.back(), 17, 1e-3);
    EXPECT_EQ(torque.channel->unit, "N*m");
    const auto length = trial.Find("tib_ant_fascicle_1");
    EXPECT_EQ(static_cast<bool>(length), !passive);
    if (length) {
      EXPECT_EQ(length.grid->time.size(), 500U);
      EXPECT_NEAR(length.grid->time[1] - length.grid->time[0], 0.03, 1e-9);
      EXPECT_GT(length.channel->values.front(), 0.06);
      EXPECT_LT(length.channel->values.front(), 0.082);
    }
    ++recordings;
  }
  EXPECT_EQ(recordings, 14);
}

TEST(SharedData, AnAnkleHeldInDorsiflexionIsPulledIntoPlantarflexion) {
  SKIP_WITHOUT("dynamometer_ankle");
  ImportOptions options;
  const auto map =
      ReadImportMap(std::string(SINEW_SOURCE_DIR) + "/docs/examples/dynamometer_ankle/passive.yaml");
  ASSERT_TRUE(map) << ErrorOf(map);
  options.map = *map;
  Dataset dataset;
  std::vector<std::string> notes;
  ASSERT_EQ(ErrorOf(ImportFile(Shared("dynamometer_ankle/Pas_-15.mat"), options, dataset, notes)), "");
  const Trial& trial = dataset.trials.at("Pas_-15");
  const auto median = [](std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + 17000, values.end());
    return values[17000];
  };
  EXPECT_NEAR(median(trial.Find("machine_angle").channel->values), 20 * kPi / 180, 0.002);
  EXPECT_NEAR(median(trial.Find("machine_torque").channel->values), -18.1, 0.05);
}

}  // namespace
}  // namespace sinew
