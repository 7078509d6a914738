#include "datasets/cut.h"

#include "tests/datasets/support.h"

namespace sinew {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// 0 .. 4 s in steps of 0.1 s on every grid.
Dataset Recording() {
  Dataset dataset;
  Trial& trial = dataset.trials["walk"];
  trial.task = "walking";
  trial.conditions["speed_m_per_s"] = 1.2;
  for (const char* name : {"forces", "coordinates", "markers", "emg"}) {
    Grid& grid = trial.grids[name];
    Channel& channel = grid.channels[std::string(name) + "_channel"];
    channel.unit = "1";
    channel.kind = std::string(name) == "emg" ? ChannelKind::kInput : ChannelKind::kMeasured;
    for (int i = 0; i <= 40; ++i) {
      grid.time.push_back(0.1 * i);
      channel.values.push_back(i);
    }
  }
  return dataset;
}

TEST(CutTrial, KeepsTheWindowAndAMarginForSplinesAndInputs) {
  Dataset dataset = Recording();
  ASSERT_EQ(ErrorOf(CutTrial(dataset, {"walk", 1.0, 1.3, "stance", Role::kValidate})), "");
  const Trial& stance = dataset.trials.at("stance");
  EXPECT_EQ(stance.role, Role::kValidate);
  EXPECT_EQ(stance.task, "walking");
  EXPECT_THAT(stance.grids.at("forces").channels.at("forces_channel").values, ElementsAre(10, 11, 12, 13));
  EXPECT_EQ(stance.grids.at("forces").time.size(), 4U);
  for (const char* name : {"coordinates", "markers", "emg"}) {  // 0.75 .. 1.55 s
    EXPECT_THAT(stance.grids.at(name).channels.at(std::string(name) + "_channel").values,
                ElementsAre(8, 9, 10, 11, 12, 13, 14, 15))
        << name;
  }
  EXPECT_EQ(stance.cut_from, "walk");
  EXPECT_EQ(stance.conditions.at("window_start_s"), 1.0);
  EXPECT_EQ(stance.conditions.at("window_end_s"), 1.3);
  EXPECT_EQ(stance.conditions.at("speed_m_per_s"), 1.2);
  EXPECT_EQ(dataset.trials.at("walk").grids.at("forces").time.size(), 41U);
  EXPECT_EQ(ErrorOf(dataset.Check()), "");
}

TEST(CutTrial, RoleIsThatOfTheSourceAndTheMarginCanBeNone) {
  Dataset dataset = Recording();
  dataset.trials["walk"].role = Role::kValidate;
  ASSERT_EQ(ErrorOf(CutTrial(dataset, {"walk", 1.0, 1.1, "stance", {}, 0})), "");
  EXPECT_EQ(dataset.trials.at("stance").role, Role::kValidate);
  EXPECT_EQ(dataset.trials.at("stance").grids.at("markers").time.size(), 2U);
}

TEST(CutTrial, APartOfAPartIsOfTheRecording) {
  Dataset dataset = Recording();
  ASSERT_EQ(ErrorOf(CutTrial(dataset, {"walk", 1.0, 2.0, "half"})), "");
  ASSERT_EQ(ErrorOf(CutTrial(dataset, {"half", 1.2, 1.5, "quarter"})), "");
  EXPECT_EQ(dataset.trials.at("quarter").cut_from, "walk");
}

TEST(CutTrial, BadWindowsAreErrorsAndChangeNothing) {
  const std::pair<TrialWindow, std::string> cases[] = {
      {{"walkk", 1, 2, "stance"}, "no trial 'walkk'; did you mean 'walk'?"},
      {{"walk", 1, 2, "walk"}, "there is a trial 'walk' already"},
      {{"walk", 5, 6, "stance"},
       "the window 5:6 s holds no sample of 'coordinates' in trial 'walk', which covers 0:4 s"},
      {{"walk", 2, 1, "stance"}, "the window 2:1 s holds no sample"},
      {{"walk", 1, 1, "stance"}, "the window 1:1 s holds no sample"},
      {{"walk", 1.01, 1.05, "stance"}, "covers 0:4 s"},
      {{"walk", 1, std::nan(""), "stance"}, "not finite"},
      {{"walk", 1, 2, "stance", {}, -1}, "the margin is -1 s"},
  };
  for (const auto& [window, message] : cases) {
    Dataset dataset = Recording();
    EXPECT_THAT(ErrorOf(CutTrial(dataset, window)), HasSubstr(message));
    EXPECT_EQ(dataset.trials.size(), 1U);
  }
}

TEST(SplitTrial, EverySampleBelongsToOnePiece) {
  Dataset dataset = Recording();
  dataset.trials["walk"].role = Role::kValidate;
  const auto names = SplitTrial(dataset, "walk", 1.1);
  ASSERT_TRUE(names);
  // 4 s: four pieces, the last one as long as is left.
  EXPECT_THAT(*names, ElementsAre("walk_1", "walk_2", "walk_3", "walk_4"));
  EXPECT_EQ(dataset.trials.size(), 4U);
  std::vector<double> forces;
  for (const std::string& name : *names) {
    const Trial& piece = dataset.trials.at(name);
    EXPECT_EQ(piece.role, Role::kValidate);
    EXPECT_EQ(piece.cut_from, "walk");
    EXPECT_EQ(piece.conditions.at("speed_m_per_s"), 1.2);
    const auto& values = piece.grids.at("forces").channels.at("forces_channel").values;
    forces.insert(forces.end(), values.begin(), values.end());
  }
  ASSERT_EQ(forces.size(), 41U);
  for (std::size_t i = 0; i < forces.size(); ++i) EXPECT_EQ(forces[i], static_cast<double>(i));
  EXPECT_THAT(dataset.trials.at("walk_2").grids.at("forces").time.front(), testing::DoubleNear(1.1, 1e-12));
  EXPECT_THAT(dataset.trials.at("walk_2").grids.at("emg").time.front(), testing::DoubleNear(0.9, 1e-12));
  EXPECT_EQ(ErrorOf(dataset.Check()), "");
}

TEST(SplitTrial, NamesAreInTheOrderOfTime) {
  Dataset dataset = Recording();
  const auto names = SplitTrial(dataset, "walk", 0.35);
  ASSERT_TRUE(names);
  EXPECT_EQ(names->size(), 11U);
  EXPECT_EQ(names->front(), "walk_01");
  EXPECT_EQ(names->back(), "walk_11");
  double before = -1;
  for (const std::string& name : *names) {
    EXPECT_GT(dataset.trials.at(name).grids.at("forces").time.front(), before);
    before = dataset.trials.at(name).grids.at("forces").time.back();
  }
}

TEST(SplitTrial, ATrialThatIsTooShortStays) {
  Dataset dataset = Recording();
  const auto names = SplitTrial(dataset, "walk", 2.8);
  ASSERT_TRUE(names);
  EXPECT_THAT(*names, ElementsAre("walk"));
  EXPECT_EQ(dataset.trials.at("walk").cut_from, "");
}

TEST(SplitTrial, BadWishesAreErrorsAndChangeNothing) {
  Dataset dataset = Recording();
  dataset.trials["walk_2"] = dataset.trials["walk"];
  EXPECT_THAT(ErrorOf(SplitTrial(dataset, "walkk", 1)), HasSubstr("did you mean 'walk'?"));
  EXPECT_THAT(ErrorOf(SplitTrial(dataset, "walk", 1)), HasSubstr("there is a trial 'walk_2' already"));
  for (const double length : {0.0, -1.0, std::nan(""), HUGE_VAL})
    EXPECT_THAT(ErrorOf(SplitTrial(dataset, "walk", length)), HasSubstr("expected more than 0"));
  EXPECT_THAT(ErrorOf(SplitTrial(dataset, "walk", 1e-5)), HasSubstr("expected at most 10000"));
  EXPECT_THAT(ErrorOf(SplitTrial(dataset, "walk", 0.01)), HasSubstr("holds no sample"));
  dataset.trials["walk"].grids["late"].time = {5};
  EXPECT_THAT(ErrorOf(SplitTrial(dataset, "walk", 1)), HasSubstr("cover no common time"));
  EXPECT_EQ(dataset.trials.size(), 2U);
  EXPECT_EQ(dataset.trials.at("walk").grids.at("forces").time.size(), 41U);
}

TEST(KeepPlates, DropsTheChannelsOfOtherPlatesOnly) {
  Trial trial;
  for (const char* name :
       {"right_force_y", "right_cop_x", "left_force_y", "left_cop_x", "left_moment_y", "knee"})
    trial.grids["forces"].channels[name] = {};
  EXPECT_EQ(ErrorOf(KeepPlates(trial, {"right", "middle"})), "has no channel middle_force_y");
  EXPECT_EQ(trial.grids["forces"].channels.size(), 6U);
  ASSERT_EQ(ErrorOf(KeepPlates(trial, {"right"})), "");
  std::vector<std::string> left;
  for (const auto& [name, channel] : trial.grids["forces"].channels) left.push_back(name);
  EXPECT_THAT(left, ElementsAre("knee", "right_cop_x", "right_force_y"));
}

}  // namespace
}  // namespace sinew
