#include "models/multibody/ik_setup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/models/multibody/test_models.h"

namespace sinew {
namespace {

using testing::HasSubstr;

const std::string kSetup = R"(<OpenSimDocument Version="30000">
<InverseKinematicsTool>
  <IKTaskSet><objects>
    <IKMarkerTask name="RASI"><apply>true</apply><weight>3</weight></IKMarkerTask>
    <IKMarkerTask name="LASI"><apply>false</apply><weight>1</weight></IKMarkerTask>
    <IKCoordinateTask name="knee"><apply>true</apply><weight>0.5</weight>
      <value_type>manual_value</value_type><value>-0.4</value></IKCoordinateTask>
  </objects></IKTaskSet>
  <time_range> 0.5 2.5</time_range>
</InverseKinematicsTool>
</OpenSimDocument>
)";

TEST(ReadIkSetup, ReadsTasksAndTimes) {
  const auto setup = *ReadIkSetup(kSetup, "s.xml");
  ASSERT_EQ(setup.markers.size(), 2U);
  EXPECT_EQ(setup.markers[0].name, "RASI");
  EXPECT_EQ(setup.markers[0].weight, 3);
  EXPECT_TRUE(setup.markers[0].apply);
  EXPECT_FALSE(setup.markers[1].apply);
  ASSERT_EQ(setup.coordinates.size(), 1U);
  EXPECT_EQ(setup.coordinates[0].target, IkSetup::Target::kManualValue);
  EXPECT_EQ(setup.coordinates[0].value, -0.4);
  EXPECT_EQ(setup.start_time, 0.5);
  EXPECT_EQ(setup.end_time, 2.5);
}

TEST(ReadIkSetup, ReadsOpenSimsOwn) {
  const std::string text = ReadText(kSharedData + "/gait_subject01/IK_walk_Setup_IK.xml");
  if (text.empty()) GTEST_SKIP() << "no shared data at " << kSharedData;
  const auto setup = *ReadIkSetup(text, "s.xml");
  EXPECT_EQ(setup.markers.size(), 39U);
  EXPECT_EQ(setup.end_time, 2.5);
}

TEST(ReadIkSetup, RejectsBadInput) {
  const auto message = [](const std::string& text) { return ReadIkSetup(text, "s.xml").error().message; };
  EXPECT_THAT(message("nonsense"), HasSubstr("s.xml:1: not well-formed"));
  EXPECT_THAT(message("<OpenSimDocument Version=\"30000\"/>"), HasSubstr("there is no <IKTaskSet>"));
  EXPECT_THAT(message(Replaced(kSetup, "<weight>3<", "<weight>-3<")),
              HasSubstr("s.xml:4: weight of IKMarkerTask"));
  EXPECT_THAT(message(Replaced(kSetup, "manual_value", "guess")),
              HasSubstr("s.xml:7: value_type is 'guess'"));
  EXPECT_THAT(message(Replaced(kSetup, "<IKTaskSet>", "<IKTaskSet file=\"t.xml\">")), HasSubstr("'t.xml'"));
  EXPECT_THAT(message(Replaced(kSetup, "0.5 2.5", "2.5")), HasSubstr("time_range"));
}

}  // namespace
}  // namespace sinew
