// Data that a contact problem cannot be made of: each gets one clear message.
#include "problems/contact/data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/problems/support/stepping_data.h"

namespace sinew {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

// ExactData has train_1 on the right plate, train_2 on the left, validate_1 on the right.
constexpr const char* kTrial = "train_1";

std::string ErrorAfter(const std::function<void(Dataset&)>& damage, const std::string& what = "",
                       const std::string& by = "") {
  Dataset data = ExactData();
  const std::string yaml = SettingsText(data, what, by);
  damage(data);
  const auto problem = MakeContact(data, yaml);
  return problem ? "" : problem.error().message;
}

std::string ErrorWith(const std::string& what, const std::string& by) {
  return ErrorAfter([](Dataset&) {}, what, by);
}

void EraseChannel(Dataset& data, const std::string& channel) {
  for (auto& [trial_name, trial] : data.trials) {
    for (auto& [grid_name, grid] : trial.grids) grid.channels.erase(channel);
  }
}

TEST(ContactData, GoodDataHasAStancePerTrialAndPlate) {
  const auto problem = MakeContact(ExactData(), SettingsText(ExactData())).value();
  const ContactData& data = problem->data();
  ASSERT_EQ(data.stances.size(), 3U);
  EXPECT_EQ(data.stances[0].plate, "right");
  EXPECT_EQ(data.stances[1].plate, "left");
  EXPECT_EQ(data.layout.size(), 18U);
  EXPECT_THAT(data.notes, IsEmpty());
  const Block& vertical = data.layout[static_cast<std::size_t>(data.stances[2].blocks[1])];
  EXPECT_EQ(vertical.trial, "validate_1");
  EXPECT_EQ(vertical.channel, "right_force_y");
  EXPECT_EQ(vertical.role, BlockRole::kValidate);
  EXPECT_EQ(vertical.measured, ExactData().trials.at("validate_1").Find("right_force_y").channel->values);
}

TEST(ContactData, AMarginIsPredictedAroundTheSamples) {
  constexpr double kMargin = 0.1;
  const auto problem = MakeContact(ExactData(), SettingsText(ExactData()), kMargin).value();
  const Block& block = problem->layout()[1];
  const auto& time = ExactData().trials.at(kTrial).grids.at("forces").time;
  EXPECT_NEAR(block.prediction_time.front(), time.front() - kMargin, 1.0 / 60);
  EXPECT_NEAR(block.prediction_time.back(), time.back() + kMargin, 1.0 / 60);
  ASSERT_EQ(block.sample.size(), time.size());
  for (std::size_t i = 0; i < time.size(); ++i) {
    EXPECT_EQ(block.prediction_time[static_cast<std::size_t>(block.sample[i])], time[i]);
  }
}

TEST(ContactData, ForcesAndMotionMustOverlap) {
  EXPECT_THAT(ErrorAfter([](Dataset& data) {
                for (double& t : data.trials[kTrial].grids["coordinates"].time) t += 10;
              }),
              HasSubstr("trial 'train_1': forces (0 .. 0.5167 s) and motion (9.8 .. 10.7"));
}

TEST(ContactData, AGapInsideTheMotionIsAnError) {
  EXPECT_EQ(ErrorAfter([](Dataset& data) {
              data.trials[kTrial].grids["coordinates"].channels["knee_angle_r"].values[18] = std::nan("");
            }),
            "trial 'train_1': the motion has a gap at t = 0.1 s; cut the trial so that it lies outside");
}

TEST(ContactData, AGapAtTheEndOfTheMotionLeavesSamplesOutAndSaysSo) {
  Dataset data = ExactData();
  Grid& grid = data.trials[kTrial].grids["coordinates"];
  for (std::size_t i = 0; i < grid.time.size(); ++i) {
    if (grid.time[i] > 0.45) grid.channels["knee_angle_r"].values[i] = std::nan("");
  }
  const auto problem = MakeContact(data, SettingsText(data));
  ASSERT_TRUE(problem) << problem.error().message;
  EXPECT_EQ((*problem)->layout()[1].samples(), 28);  // 0 .. 27/60 s
  EXPECT_THAT((*problem)->data().notes,
              ElementsAre("trial 'train_1': 4 of 32 samples of 'right_force_y' are not compared"
                          " (gaps, no motion there, or a light foot)"));
}

TEST(ContactData, AGapInTheForceIsSkipped) {
  Dataset data = ExactData();
  data.trials[kTrial].grids["forces"].channels["right_force_y"].values[7] = std::nan("");
  const auto problem = MakeContact(data, SettingsText(data));
  ASSERT_TRUE(problem) << problem.error().message;
  const Block& block = (*problem)->layout()[1];
  EXPECT_EQ(block.samples(), 31);
  EXPECT_EQ(block.predictions(), 32);
  EXPECT_EQ(block.sample[7], 8);
}

TEST(ContactData, ACoordinateThatIsMissingIsHeldAndSaidSo) {
  Dataset data = ExactData();
  EraseChannel(data, "head_yaw");
  const auto problem = MakeContact(data, SettingsText(data));
  ASSERT_TRUE(problem) << problem.error().message;
  EXPECT_THAT(
      (*problem)->data().notes,
      ElementsAre("trial 'train_1'; trial 'train_2'; trial 'validate_1': no data for head_yaw: held at the"
                  " model's default"));
}

TEST(ContactData, TheMotionMustBeThere) {
  EXPECT_THAT(ErrorAfter([](Dataset& data) { data.trials[kTrial].grids.erase("coordinates"); }),
              StartsWith("trial 'train_1': has no coordinate of the model (pelvis_"));
  EXPECT_NE(ErrorAfter([](Dataset& data) {
              for (auto& [name, channel] : data.trials[kTrial].grids["coordinates"].channels)
                std::fill(channel.values.begin(), channel.values.end(), std::nan(""));
            }),
            "");
}

TEST(ContactData, TheModelMustBeThereAndBeUnderstood) {
  EXPECT_EQ(
      ErrorAfter([](Dataset& data) { data.files.erase("model.osim"); }),
      "the data set holds no file 'model.osim' (its files: contact.yaml); import the .osim that the motion "
      "belongs to");
  EXPECT_THAT(ErrorAfter([](Dataset& data) { data.files["model.osim"] = "<OpenSimDocument"; }),
              HasSubstr("model.osim"));
}

TEST(ContactData, TheBodyMustExist) {
  EXPECT_THAT(ErrorWith("body: calcn_r", "body: calc_r"), StartsWith("contact region 'right_sole': "));
  EXPECT_THAT(ErrorWith("body: calcn_r", "body: calc_r"), HasSubstr("did you mean 'calcn_r'"));
}

TEST(ContactData, AFittedChannelMustBeMeasured) {
  EXPECT_EQ(ErrorWith("fit: [force_y]", "fit: [force_y, cop_x]"),
            "trial 'train_1': channel 'right_cop_x' is to be fitted but is not measured");
  EXPECT_EQ(
      ErrorAfter([](Dataset& data) { EraseChannel(data, "right_force_x"); }, "fit: [force_y]", kFitsForce),
      "trial 'train_1': channel 'right_force_x' is to be fitted but is not measured");
  EXPECT_EQ(ErrorAfter([](Dataset& data) {
              auto& values = data.trials[kTrial].grids["forces"].channels["right_force_y"].values;
              std::fill(values.begin(), values.end(), std::nan(""));
            }),
            "trial 'train_1': right_force_y has no value: a step without a plate can only be predicted (role "
            "validate)");
}

TEST(ContactData, SomeTrialMustHaveAForce) {
  EXPECT_EQ(
      ErrorAfter([](Dataset& data) {
        EraseChannel(data, "right_force_y");
        EraseChannel(data, "left_force_y");
      }),
      "no trial has a vertical force of the plates right, left: expected a channel such as right_force_y");
}

TEST(ContactData, ObjectivesNeedWhatTheyDivideBy) {
  EXPECT_EQ(
      ErrorWith("objective: thesis", "objective: likelihood"),
      "trial 'train_1': objective likelihood needs the noise level (attribute sigma) of 'right_force_y'");
  const auto make_constant = [](Dataset& data) {
    auto& values = data.trials[kTrial].grids["forces"].channels["right_force_y"].values;
    std::fill(values.begin(), values.end(), 7);
  };
  EXPECT_EQ(ErrorAfter(make_constant, "objective: thesis", "objective: normalised"),
            "trial 'train_1': channel 'right_force_y' does not vary: nothing to fit");
}

TEST(ContactData, WithMotionErrorsAPlateMustCarryAnUpwardForce) {
  const auto turn_over = [](Dataset& data) {
    for (double& value : data.trials[kTrial].grids["forces"].channels["right_force_y"].values) value *= -1;
  };
  EXPECT_EQ(ErrorAfter(turn_over, "objective: thesis", "objective: likelihood\n  motion_errors: {}"),
            "trial 'train_1': plate 'right' never carries an upward force: is it upside down?");
}

TEST(ContactData, TheCentreOfPressureIsComparedUnderALoadedFootOnly) {
  Dataset data = ExactData();
  EraseChannel(data, "left_force_y");  // train_2 takes no part
  for (const char* name : {"train_1", "validate_1"}) {
    Grid& grid = data.trials[name].grids["forces"];
    Channel cop = grid.channels["right_force_y"];
    cop.unit = "m";
    grid.channels["right_cop_x"] = cop;
  }
  const auto problem = MakeContact(data, SettingsText(data, "fit: [force_y]", "fit: [cop_x]")).value();
  const Block& block = problem->layout()[3];
  ASSERT_EQ(block.channel, "right_cop_x");
  const auto& force = data.trials[kTrial].grids["forces"].channels["right_force_y"].values;
  const double most = *std::max_element(force.begin(), force.end());
  EXPECT_GT(block.samples(), 0);
  EXPECT_LT(block.samples(), static_cast<int>(force.size()));
  for (const double measured : block.measured) EXPECT_GT(measured, 0.1 * most);
}

}  // namespace
}  // namespace sinew
