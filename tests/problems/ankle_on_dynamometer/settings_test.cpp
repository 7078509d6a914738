#include "problems/ankle_on_dynamometer/settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/problems/ankle_on_dynamometer/ankle_bench.h"

namespace sinew {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string SettingsError(const std::string& what, const std::string& by) {
  const auto settings = ReadAnkleYaml(ChangedAnkleYaml(what, by));
  return settings ? "" : settings.error().message;
}

TEST(AnkleSettingsTest, EveryKeyIsRead) {
  const auto read = ReadAnkleYaml(ChangedAnkleYaml(
      "  step: 0.005\n",
      "  step: 0.004\n  gravity: 9.8\n  shank_tilt: 0.4\n  transition_velocity: 0.03\n  angle_cutoff: 12\n"
      "  rate: 50\n  torque_zero: 0.5\n"));
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->step, 0.004);
  EXPECT_EQ(read->foot.gravity, 9.8);
  EXPECT_EQ(read->foot.shank_tilt, 0.4);
  EXPECT_EQ(read->foot.transition_velocity, 0.03);
  EXPECT_EQ(read->angle_cutoff, 12);
  EXPECT_EQ(read->rate, 50);
  EXPECT_EQ(read->torque_zero, 0.5);
  EXPECT_EQ(read->foot.ankle_height, 0.08);
  EXPECT_EQ(read->foot.inertia, 0.008);
  EXPECT_EQ(read->foot.strips, 16);
  ASSERT_EQ(read->foot.straps.size(), 2U);
  EXPECT_EQ(read->foot.straps[0].foot_y, -0.03);
  EXPECT_EQ(read->foot.straps[1].plate_x, 0.035);
  ASSERT_EQ(read->muscles.size(), 2U);
  EXPECT_EQ(read->muscles[0].group, "triceps");
  EXPECT_EQ(read->muscles[1].group, "tib_ant_r");
  EXPECT_EQ(read->muscles[1].excitation, "tib_ant_r");
  EXPECT_EQ(read->muscles[0].path.arm.size(), 3U);
  EXPECT_EQ(*read->parameters.at("strap_stiffness").prior, 0.5);
}

TEST(AnkleSettingsTest, NothingIsNeeded) {
  const auto read = ReadAnkleYaml("ankle_on_dynamometer: {}\n");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->foot.straps.size(), DefaultStraps().size());
  EXPECT_TRUE(read->muscles.empty());
  EXPECT_LT(read->angle_cutoff, 0);
}

TEST(AnkleSettingsTest, ErrorsSayFileAndLine) {
  EXPECT_EQ(SettingsError("  strips: 16", "  stripes: 16"),
            "ankle.yaml:6: unknown key 'stripes'; did you mean 'strips'?");
  EXPECT_THAT(SettingsError("heel: 0.05", "heal: 0.05"),
              StartsWith("ankle.yaml:2: unknown key 'heal'; did you mean 'heel'?"));
  EXPECT_THAT(SettingsError("heel: 0.05", "heel: -0.05"), StartsWith("ankle.yaml:2: heel: -0.05, expected"));
  EXPECT_THAT(SettingsError("inertia: 0.008", "inertia: 0"),
              StartsWith("ankle.yaml:2: inertia: 0, expected"));
  EXPECT_THAT(SettingsError("foot: [0.11, -0.03]", "foot: [0.11]"), StartsWith("ankle.yaml:4: "));
  EXPECT_THAT(SettingsError("foot: [0.11, -0.03], ", ""), StartsWith("ankle.yaml:4: "));
  EXPECT_THAT(SettingsError("plate: 0.035", "plate: front"), StartsWith("ankle.yaml:5: "));
  EXPECT_THAT(SettingsError("strips: 16", "strips: 0"), StartsWith("ankle.yaml:6: strips: 0, expected"));
  EXPECT_THAT(SettingsError("step: 0.005", "step: 0"), StartsWith("ankle.yaml:7: step: 0, expected"));
  EXPECT_THAT(SettingsError("length: 0.314, ", ""), HasSubstr("expected key 'length'"));
  EXPECT_THAT(SettingsError("isometric_force: 905", "isometric_force: none"), StartsWith("ankle.yaml:11: "));
  EXPECT_THAT(SettingsError("[0.041, -0.006, -0.02]", "[]"),
              StartsWith("ankle.yaml:12: arm: 0 numbers, expected 1 to 8"));
  EXPECT_THAT(SettingsError("prior: 0.5", "prior: 0"),
              StartsWith("ankle.yaml:14: prior: 0, expected a standard deviation above 0"));
  EXPECT_THAT(SettingsError("prior: 0.5", "priors: 0.5"), StartsWith("ankle.yaml:14: unknown key 'priors'"));
  EXPECT_THAT(SettingsError("  strips: 16", "  strips: [1"), StartsWith("ankle.yaml:"));
}

TEST(AnkleSettingsTest, ChangesOfParametersAreChecked) {
  const auto error = [](const std::string& by) {
    const auto settings = ReadAnkleYaml(
        ChangedAnkleYaml("strap_stiffness: {start: 6000, lower: 1.0e3, upper: 1.0e5, prior: 0.5}", by));
    EXPECT_TRUE(settings) << settings.error().message;
    const auto problem = AnkleProblem::Make(AnkleBenchData(), *settings);
    return problem ? "" : problem.error().message;
  };
  EXPECT_EQ(error("strap_exponent: {start: 70}"), "");
  EXPECT_THAT(error("strap_stifness: {start: 70}"), HasSubstr("did you mean 'strap_stiffness'?"));
  EXPECT_THAT(error("strap_stiffness: {start: 10}"),
              StartsWith("parameters: strap_stiffness: start 10 and range 200 to 1000000, expected"));
  EXPECT_THAT(error("strap_stiffness: {lower: 0}"), HasSubstr("above 0"));
  EXPECT_THAT(error("passive_damping: {lower: 5, upper: 2, start: 3}"), HasSubstr("expected a start within"));
}

TEST(AnkleSettingsTest, AStartMovesItsPrior) {
  const auto list = ListAnkleParameters(AnkleBenchSettings());
  ASSERT_TRUE(list) << list.error().message;
  const Parameter& strap =
      list->parameters[static_cast<std::size_t>(*FindParameter(list->parameters, "strap_stiffness"))];
  EXPECT_EQ(strap.start, 6000);
  EXPECT_EQ(strap.upper, 1e5);
  ASSERT_TRUE(strap.prior);
  EXPECT_DOUBLE_EQ(strap.prior->mean, std::log(6000));
  EXPECT_EQ(strap.prior->standard_deviation, 0.5);
}

}  // namespace
}  // namespace sinew
