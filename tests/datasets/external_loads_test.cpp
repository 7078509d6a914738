#include "datasets/io/external_loads.h"

#include "datasets/io/plates.h"
#include "tests/datasets/support.h"

namespace sinew {
namespace {

using testing::StartsWith;

std::string Loads(const std::string& forces) {
  return "<OpenSimDocument Version=\"30000\">\n<ExternalLoads name=\"grf\">\n<objects>\n" + forces +
         "</objects>\n</ExternalLoads>\n</OpenSimDocument>\n";
}

std::string Force(const std::string& name, const std::string& extra = "") {
  return "<ExternalForce name=\"" + name +
         "\"><applied_to_body> calcn_r </applied_to_body><force_identifier>ground_force_v</force_identifier>"
         "<point_identifier>ground_force_p</point_identifier><torque_identifier>Unassigned</"
         "torque_identifier>" +
         extra + "</ExternalForce>\n";
}

TEST(ExternalLoads, ForcesThatAreSwitchedOn) {
  const auto loads = ParseExternalLoads(Loads(Force("right") + Force("off", "<isDisabled>true</isDisabled>") +
                                              Force("off4", "<appliesForce>false</appliesForce>")),
                                        "x.xml");
  ASSERT_TRUE(loads) << ErrorOf(loads);
  ASSERT_EQ(loads->size(), 1U);
  EXPECT_EQ(loads->front().name, "right");
  EXPECT_EQ(loads->front().applied_to_body, "calcn_r");
  EXPECT_EQ(loads->front().force_identifier, "ground_force_v");
  EXPECT_EQ(loads->front().point_identifier, "ground_force_p");
  EXPECT_EQ(loads->front().torque_identifier, "");
}

TEST(ExternalLoads, BadFilesAreErrorsWithTheirLine) {
  const std::pair<std::string, std::string> cases[] = {
      {"", "x.xml:1: not valid XML"},
      {"<a>\n<b>\n</a>\n", "x.xml:3: not valid XML"},
      {"<OpenSimDocument/>", "x.xml: has no element ExternalLoads"},
      {Loads(""), "x.xml:2: ExternalLoads holds no ExternalForce"},
      {Loads(Force("right") + Force("right")), "x.xml:5: the name 'right' appears twice"},
      {Loads(Force("")), "x.xml:4: an ExternalForce has no name"},
      {Loads(Force("r", "<force_expressed_in_body>calcn_r</force_expressed_in_body>")),
       "x.xml:4: 'r': force_expressed_in_body is 'calcn_r', expected ground"},
      {Loads("\n<ExternalForce name=\"r\"><applied_to_body>b</applied_to_body></ExternalForce>\n"),
       "x.xml:5: 'r' has no force_identifier"},
      {Loads("<ExternalForce name=\"r\"/>"), "x.xml:4: 'r' has no applied_to_body"},
  };
  for (const auto& [text, message] : cases) {
    EXPECT_THAT(ErrorOf(ParseExternalLoads(text, "x.xml")), StartsWith(message)) << text;
  }
}

std::vector<std::string> Axes(const std::vector<std::string>& identifiers) {
  std::vector<std::string> names;
  for (const std::string& identifier : identifiers) {
    for (const char axis : {'x', 'y', 'z'}) names.push_back(identifier + axis);
  }
  return names;
}

TEST(Plates, TextOfTheCommandLine) {
  const auto plates = ParsePlates("right=ground_, left=1_ground_");
  ASSERT_TRUE(plates) << ErrorOf(plates);
  ASSERT_EQ(plates->size(), 2U);
  EXPECT_EQ((*plates)[1].plate, "left");
  EXPECT_EQ((*plates)[1].prefix, "1_ground_");
  for (const char* text : {"", "right", "right=", "=ground_", "right=a,right=b", "right=a,"}) {
    EXPECT_THAT(ErrorOf(ParsePlates(text)), StartsWith("plates: ")) << text;
  }
}

TEST(Plates, ColumnsOfAPrefixBeginWithIt) {
  const auto names = Axes({"ground_force_v", "ground_force_p", "1_ground_force_v", "1_ground_force_p",
                           "ground_torque_", "1_ground_torque_"});
  for (const char* prefix : {"ground_", "ground_force_", "ground_force_v"}) {
    const auto found = FindPlateColumns({"right", prefix}, names);
    ASSERT_TRUE(found) << ErrorOf(found);
    ASSERT_TRUE(*found) << prefix;
    EXPECT_EQ((*found)->force, "ground_force_v");
    EXPECT_EQ((*found)->point, "ground_force_p");
    EXPECT_EQ((*found)->torque, "ground_torque_");
  }
  EXPECT_EQ((*FindPlateColumns({"left", "1_ground_"}, names))->force, "1_ground_force_v");
  EXPECT_FALSE(*FindPlateColumns({"left", "2_ground_"}, names));
}

TEST(Plates, OtherSpellingsAndAmbiguity) {
  const auto numbered = Axes({"ground_force_1_v", "ground_force_1_p", "ground_moment_1_m"});
  const auto found = FindPlateColumns({"right", "ground_force_1_"}, numbered);
  ASSERT_TRUE(found && *found);
  EXPECT_EQ((*found)->torque, "ground_moment_1_m");

  const auto only_force = FindPlateColumns({"right", "ground_"}, Axes({"ground_force_v"}));
  ASSERT_TRUE(only_force && *only_force);
  EXPECT_EQ((*only_force)->point, "");

  EXPECT_THAT(ErrorOf(FindPlateColumns({"right", "a_"}, Axes({"a_force_v", "a_v"}))),
              StartsWith("plate 'right': the prefix 'a_' fits"));
}

}  // namespace
}  // namespace sinew
