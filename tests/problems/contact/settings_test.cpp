#include "problems/contact/settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/random.h"
#include "tests/problems/support/stepping_data.h"

namespace sinew {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kSettings = R"(contact:
  model: robot.osim
  floor_height: 0.01
  floor_velocity: [0.5, -0.25]
  transition_velocity: 0.02
  objective: likelihood
  fit: [force_y, cop_x]
  cop_force_share: 0.2
  regions:
    - name: heel
      body: calcn_r
      plate: right
      group: rubber
      springs: all
      position: [0.1, 0.2, 0.3]
      orientation: [0, 1.5707963267948966, 0]
      mesh: {box: {size: [0.16, 0.02, 0.09], strips: [4, 3]}}
    - name: toe
      body: toes_r
      plate: right
      mesh: {outline: {corners: [[0, 0], [0.2, 0], [0.2, 0.1], [0, 0.1]], thickness: 0.02, strips: [4, 2]}}
  parameters:
    stiffness: {lower: 2.0e4, upper: 3.0e6, start: 5.0e5}
    dissipation: {start: 20}
)";

class ContactSettingsTest : public testing::Test {
 protected:
  [[nodiscard]] Result<ContactSettings> Read(const std::string& yaml) const {
    return ParseContactSettings(data_, yaml);
  }

  /// The error after a text of the settings was replaced by another.
  [[nodiscard]] std::string ErrorAfter(const std::string& what, const std::string& by) const {
    std::string yaml = kSettings;
    const auto at = yaml.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    const auto settings = Read(yaml.replace(at, what.size(), by));
    return settings ? "" : settings.error().message;
  }
  Dataset data_;
};

TEST_F(ContactSettingsTest, AllMeshesTogetherAreLimited) {
  std::string yaml = "contact:\n  regions:\n";
  for (int i = 0; i < 3; ++i) {
    yaml += fmt::format(
        "    - {{name: r{}, body: foot, plate: right, mesh: {{box: {{size: [0.2, 0.02, 0.1], strips: [200, "
        "120]}}}}}}\n",
        i);
  }
  const auto settings = Read(yaml);
  ASSERT_FALSE(settings);
  EXPECT_THAT(settings.error().message,
              HasSubstr("regions: their meshes have more than 200000 triangles in all"));
}

TEST_F(ContactSettingsTest, EveryKeyIsRead) {
  const auto settings = Read(kSettings);
  ASSERT_TRUE(settings) << settings.error().message;
  EXPECT_EQ(settings->model, "robot.osim");
  EXPECT_EQ(settings->floor.height, 0.01);
  EXPECT_EQ(settings->floor.velocity_x, 0.5);
  EXPECT_EQ(settings->floor.velocity_z, -0.25);
  EXPECT_EQ(settings->transition_velocity, 0.02);
  EXPECT_EQ(settings->objective, ContactObjective::kLikelihood);
  EXPECT_THAT(settings->fit, ElementsAre("force_y", "cop_x"));
  EXPECT_EQ(settings->cop_force_share, 0.2);
  ASSERT_EQ(settings->regions.size(), 2U);
  const ContactRegionSettings& heel = settings->regions[0];
  EXPECT_EQ(heel.region.name, "heel");
  EXPECT_EQ(heel.body, "calcn_r");
  EXPECT_EQ(heel.plate, "right");
  EXPECT_EQ(heel.region.position, Vec3(0.1, 0.2, 0.3));
  EXPECT_LT((heel.region.rotation * Vec3::UnitX() + Vec3::UnitZ()).norm(), 1e-15);  // a quarter turn about y
  EXPECT_GE(heel.region.mesh.face_count(), 2 * 4 * 3);
  EXPECT_EQ(heel.region.springs, SpringFaces::kAll);
  EXPECT_EQ(settings->regions[1].region.springs, SpringFaces::kBottom);
  EXPECT_THAT(settings->Groups(), ElementsAre("rubber", "sole"));
  EXPECT_THAT(settings->Plates(), ElementsAre("right"));
  EXPECT_EQ(settings->parameters.at("stiffness").lower, 2e4);
  EXPECT_EQ(settings->parameters.at("stiffness").upper, 3e6);
  EXPECT_EQ(settings->parameters.at("dissipation").start, 20);
  EXPECT_EQ(settings->parameters.at("dissipation").upper, DefaultContactRanges().at("dissipation").upper);
}

TEST_F(ContactSettingsTest, OnlyRegionsAreNeeded) {
  const auto settings = Read(
      "contact: {regions: [{name: s, body: b, plate: p, mesh: {box: {size: [1, 1, 1], strips: [1, 1]}}}]}");
  ASSERT_TRUE(settings) << settings.error().message;
  EXPECT_EQ(settings->model, "model.osim");
  EXPECT_EQ(settings->objective, ContactObjective::kNormalised);
  EXPECT_THAT(settings->fit, ElementsAre("force_y"));
}

TEST_F(ContactSettingsTest, AnObjMeshComesFromTheFilesOfTheData) {
  const std::string mesh = "{obj: {file: sole.obj, scale: 0.1}}";
  const std::string box = "{box: {size: [0.16, 0.02, 0.09], strips: [4, 3]}}";
  EXPECT_EQ(ErrorAfter(box, mesh), "contact.yaml:17: the data set holds no file 'sole.obj': import it first");
  data_.files["sole.obj"] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  EXPECT_EQ(ErrorAfter(box, mesh), "");
  data_.files["sole.obj"] = "v 0 0 zero\n";
  EXPECT_THAT(ErrorAfter(box, mesh), HasSubstr("sole.obj:1: 'zero' is not a coordinate"));
}

TEST_F(ContactSettingsTest, UnknownKeysAreErrorsWithLineAndSuggestion) {
  EXPECT_EQ(ErrorAfter("floor_height", "flor_height"),
            "contact.yaml:3: unknown key 'flor_height'; did you mean 'floor_height'?");
  EXPECT_EQ(ErrorAfter("plate: right", "plates: right"),
            "contact.yaml:12: unknown key 'plates'; did you mean 'plate'?");
  EXPECT_THAT(ErrorAfter("box: {size", "bx: {size"), StartsWith("contact.yaml:17: unknown key 'bx'"));
  EXPECT_THAT(ErrorAfter("strips: [4, 3]", "stripes: [4, 3]"),
              StartsWith("contact.yaml:17: unknown key 'stripes'; did you mean 'strips'?"));
  EXPECT_THAT(ErrorAfter("dissipation:", "disipation:"),
              StartsWith("contact.yaml:24: unknown key 'disipation'; did you mean 'dissipation'?"));
  EXPECT_THAT(ErrorAfter("{start: 20}", "{begin: 20}"), StartsWith("contact.yaml:24: unknown key 'begin'"));
}

TEST_F(ContactSettingsTest, MissingKeysAreErrorsWithLine) {
  EXPECT_EQ(ErrorAfter("    - name: heel\n      body", "    - body"),
            "contact.yaml:10: contact.regions[0]: expected key 'name'");
  EXPECT_EQ(ErrorAfter("      body: calcn_r\n", ""),
            "contact.yaml:10: contact.regions[0]: expected key 'body'");
  EXPECT_EQ(ErrorAfter("thickness: 0.02, ", ""),
            "contact.yaml:21: contact.regions[1].mesh.outline: expected key 'thickness'");
  EXPECT_EQ(ErrorAfter("size: [0.16, 0.02, 0.09], ", ""),
            "contact.yaml:17: contact.regions[0].mesh.box: expected key 'size'");
}

TEST_F(ContactSettingsTest, WrongValuesAreErrorsWithLine) {
  EXPECT_EQ(ErrorAfter("0.01", "low"),
            "contact.yaml:3: contact.floor_height: expected a number instead of 'low'");
  EXPECT_THAT(ErrorAfter("transition_velocity: 0.02", "transition_velocity: 0"),
              HasSubstr("transition_velocity: 0 m/s, expected above 0"));
  EXPECT_EQ(ErrorAfter("likelihood", "likelyhood"),
            "contact.yaml:6: objective 'likelyhood' does not exist; did you mean 'likelihood'?");
  EXPECT_EQ(ErrorAfter("cop_x", "cop_y"),
            "contact.yaml:7: fit: channel 'cop_y' does not exist; did you mean 'cop_x'?");
  EXPECT_EQ(ErrorAfter("[force_y, cop_x]", "[]"), "contact.yaml:7: fit: expected at least one channel");
  EXPECT_EQ(ErrorAfter("[0.1, 0.2, 0.3]", "[0.1, 0.2]"),
            "contact.yaml:15: contact.regions[0].position: expected a list of 3 numbers");
  EXPECT_EQ(ErrorAfter("strips: [4, 3]", "strips: [4]"),
            "contact.yaml:17: strips: expected two whole numbers");
  EXPECT_EQ(
      ErrorAfter("strips: [4, 3]", "strips: [4, 3.5]"),
      "contact.yaml:17: contact.regions[0].mesh.box.strips[1]: expected a whole number instead of '3.5'");
  EXPECT_THAT(ErrorAfter("strips: [4, 3]", "strips: [99999999999, 3]"),
              StartsWith("contact.yaml:17: sole mesh: "));
  EXPECT_THAT(ErrorAfter("strips: [4, 3]", "strips: [0, 3]"),
              StartsWith("contact.yaml:17: sole mesh: 0 x 3 strips"));
  EXPECT_THAT(ErrorAfter("[0.16, 0.02, 0.09]", "[0.16, -0.02, 0.09]"),
              StartsWith("contact.yaml:17: sole box: size 0.16 x -0.02 x 0.09 m"));
  EXPECT_THAT(ErrorAfter("thickness: 0.02", "thickness: 0"),
              StartsWith("contact.yaml:21: sole outline: thickness 0 m"));
  EXPECT_EQ(ErrorAfter("{box: {size: [0.16, 0.02, 0.09], strips: [4, 3]}}", "{}"),
            "contact.yaml:17: mesh: expected one of box, outline, obj");
  EXPECT_EQ(ErrorAfter("floor_velocity: [0.5, -0.25]", "floor_velocity: 0.5"),
            "contact.yaml:4: contact.floor_velocity: expected a list of 2 numbers");
  EXPECT_EQ(ErrorAfter("floor_velocity: [0.5, -0.25]", "floor_velocity_error: [0.01, -1]"),
            "contact.yaml:4: floor_velocity_error: -1 m/s, expected 0 to 1");
  EXPECT_THAT(ErrorAfter("springs: all", "springs: some"),
              HasSubstr("springs: 'some', expected bottom or all"));
}

TEST_F(ContactSettingsTest, ASoleThatLooksDownNowhereIsAnError) {
  data_.files["sole.obj"] = "v 0 0 0\nv 1 0 0\nv 0 3 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n";
  const std::string inside_out = "mesh: {obj: {file: sole.obj}}";
  EXPECT_THAT(
      ErrorAfter("mesh: {outline: {corners: [[0, 0], [0.2, 0], [0.2, 0.1], [0, 0.1]], thickness: 0.02, "
                 "strips: [4, 2]}}",
                 inside_out),
      StartsWith("contact.yaml:21: mesh: no face looks down"));
}

TEST_F(ContactSettingsTest, RangesMustHoldTheirStartAndBePhysical) {
  EXPECT_EQ(ErrorAfter("start: 5.0e5", "start: 5.0e6"),
            "contact.yaml:23: stiffness: expected lower 20000 <= start 5000000 <= upper 3000000");
  EXPECT_EQ(ErrorAfter("{start: 20}", "{start: 700}"),
            "contact.yaml:24: dissipation: expected lower 0 <= start 700 <= upper 600");
  EXPECT_EQ(ErrorAfter("{start: 20}", "{lower: -1, start: 20}"),
            "contact.yaml:24: dissipation: lower -1, expected 0 or more: nothing physical is negative here");
}

TEST_F(ContactSettingsTest, RegionsMustBeThereAndHaveNamesOfTheirOwn) {
  EXPECT_EQ(Read("contact: {regions: []}").error().message, "contact.yaml:1: regions: expected at least one");
  EXPECT_EQ(Read("contact: {model: m}").error().message, "contact.yaml:1: contact: expected key 'regions'");
  EXPECT_EQ(Read("contact: {regions: 3}").error().message,
            "contact.yaml:1: contact.regions: expected a list");
  EXPECT_EQ(ErrorAfter("name: toe", "name: heel"), "contact.yaml:18: regions: the name 'heel' is used twice");
  EXPECT_EQ(ErrorAfter("name: toe", "name: ''"), "contact.yaml:18: regions: a region has no name");
}

// Whatever is broken in the text: settings or one line that says where, never a crash.
TEST_F(ContactSettingsTest, NoBytesCrashTheReader) {
  constexpr int kMutants = 4000;
  const std::string valid = kSettings;
  Random random(1);
  int accepted = 0;
  for (int round = 0; round < kMutants; ++round) {
    std::string mutated = valid;
    for (auto edits = 1 + random.Index(3); edits-- > 0;) {
      const std::size_t at = random.Index(mutated.size());
      switch (random.Index(4)) {
        case 0:
          mutated[at] = static_cast<char>(random.Index(256));
          break;
        case 1:
          mutated.erase(at, 1 + random.Index(10));
          break;
        case 2:
          mutated.insert(at, mutated.substr(random.Index(mutated.size()), random.Index(10)));
          break;
        default:
          mutated[at] = "0123456789-.eE[]{}:,'\"&*#\n "[random.Index(27)];
      }
      if (mutated.empty()) mutated = valid;
    }
    const auto settings = Read(mutated);
    if (settings) {
      ++accepted;
      EXPECT_FALSE(settings->regions.empty());
      EXPECT_FALSE(settings->fit.empty());
    } else {
      EXPECT_THAT(settings.error().message, StartsWith("contact.yaml:")) << mutated;
    }
  }
  EXPECT_GT(accepted, 0);
  EXPECT_LT(accepted, kMutants);
}

}  // namespace
}  // namespace sinew
