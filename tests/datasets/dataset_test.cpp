#include "datasets/dataset.h"

#include <cmath>
#include <limits>

#include "datasets/dataset_hash.h"
#include "tests/datasets/support.h"

namespace sinew {
namespace {

using testing::HasSubstr;

TEST(Dataset, AValidOnePassesItsCheck) {
  EXPECT_EQ(ErrorOf(SmallDataset().Check()), "");
}

TEST(Dataset, FindsChannelWithItsGrid) {
  const Dataset dataset = SmallDataset();
  const auto found = dataset.trials.at("walk").Find("right_force_y");
  ASSERT_TRUE(found);
  EXPECT_EQ(found.grid, &dataset.trials.at("walk").grids.at("forces"));
  EXPECT_EQ(found.channel->values[1], 10);
  EXPECT_FALSE(dataset.trials.at("walk").Find("nothing"));
  EXPECT_THAT(dataset.trials.at("walk").ChannelNames(),
              testing::ElementsAre("knee_angle_r", "right_force_y"));
}

// Each breaks one rule; the message must name the place.
TEST(Dataset, CheckNamesWhatIsWrongAndWhere) {
  const std::string force = "/trials/walk/forces/channels/right_force_y: ";
  const std::pair<void (*)(Dataset&), std::string> cases[] = {
      {[](Dataset& d) { d.trials["walk"].grids["forces"].time[3] = 0.5; },
       "/trials/walk/forces/time: time does not increase: sample 2 is at 0.5 s, sample 3 at 0.5 s"},
      {[](Dataset& d) { d.trials["walk"].grids["forces"].time[0] = std::nan(""); },
       "/trials/walk/forces/time: time 0"},
      {[](Dataset& d) { d.trials["walk"].grids["forces"].time.clear(); },
       "/trials/walk/forces/time: holds no samples"},
      {[](Dataset& d) { d.trials["walk"].grids["forces"].channels["right_force_y"].values.pop_back(); },
       force + "has 4 values, its time has 5"},
      {[](Dataset& d) { d.trials["walk"].grids["forces"].channels["right_force_y"].unit = "newtons"; },
       force + "unknown unit 'newtons'"},
      {[](Dataset& d) { d.trials["walk"].grids["forces"].channels["right_force_y"].unit = "kN"; },
       force + "unit 'kN', expected SI: 'N'"},
      {[](Dataset& d) { d.trials["walk"].grids["forces"].channels["right_force_y"].sigma = 0; },
       force + "sigma is 0"},
      {[](Dataset& d) {
         d.trials["walk"].grids["forces"].channels["right_force_y"].values[1] =
             std::numeric_limits<double>::infinity();
       },
       force + "value 1 is infinite"},
      {[](Dataset& d) { d.trials["walk"].grids["forces"].channels["a/b"] = {}; }, "the channel name 'a/b'"},
      {[](Dataset& d) { d.trials[""] = d.trials["walk"]; }, "/trials: a trial has no name"},
      {[](Dataset& d) { d.trials["walk"].grids.clear(); }, "/trials/walk: holds no data"},
      {[](Dataset& d) { d.trials["walk"].conditions["load_kg"] = std::nan(""); }, "condition 'load_kg'"},
      {[](Dataset& d) { d.trials["walk"].conditions["role"] = 1; }, "'role'"},
      {[](Dataset& d) { d.constants["body_mass"].unit = ""; }, "/constants/body_mass: the unit is empty"},
      {[](Dataset& d) { d.files["x"] = std::string("a\0b", 3); }, "/files/x: holds bytes that are not text"},
  };
  for (const auto& [spoil, message] : cases) {
    Dataset dataset = SmallDataset();
    spoil(dataset);
    EXPECT_THAT(ErrorOf(dataset.Check()), HasSubstr(message));
  }
}

TEST(DatasetHash, DependsOnEveryPartAndOnNothingElse) {
  const std::string hash = DatasetHash(SmallDataset());
  EXPECT_EQ(hash.size(), 16U);
  EXPECT_EQ(DatasetHash(SmallDataset()), hash);

  Dataset other_nan = SmallDataset();
  other_nan.trials["walk"].grids["forces"].channels["right_force_y"].values[2] = -std::nan("7");
  EXPECT_EQ(DatasetHash(other_nan), hash);

  void (*const changes[])(Dataset&) = {
      [](Dataset& d) { d.title += "x"; },
      [](Dataset& d) { d.synthetic = false; },
      [](Dataset& d) { d.constants["body_mass"].value = 72.7; },
      [](Dataset& d) { d.files["model.osim"] += " "; },
      [](Dataset& d) { d.trials["walk"].role = Role::kTrain; },
      [](Dataset& d) { d.trials["walk"].conditions["speed_m_per_s"] = 1.5; },
      [](Dataset& d) { d.trials["walk"].grids["forces"].time[0] = -1e-9; },
      [](Dataset& d) { d.trials["walk"].grids["forces"].channels["right_force_y"].values[1] = 10.000001; },
      [](Dataset& d) { d.trials["walk"].grids["forces"].channels["right_force_y"].sigma.reset(); },
      [](Dataset& d) {
        d.trials["walk"].grids["forces"].channels["right_force_y"].kind = ChannelKind::kInput;
      },
      [](Dataset& d) { d.trials["run"] = d.trials["walk"]; },
  };
  for (const auto& change : changes) {
    Dataset dataset = SmallDataset();
    change(dataset);
    EXPECT_NE(DatasetHash(dataset), hash);
  }
}

}  // namespace
}  // namespace sinew
