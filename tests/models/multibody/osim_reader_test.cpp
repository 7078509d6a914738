#include "models/multibody/osim_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/models/multibody/damaged_text.h"
#include "tests/models/multibody/test_models.h"

namespace sinew {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

struct SharedModel {
  const char* path;
  std::size_t bodies;
  std::size_t coordinates;
  std::size_t markers;
  double mass_kg;
};

// Counts taken from the files themselves; the mass of the gait subject is documented.
const SharedModel kSharedModels[] = {
    {"gait_subject01/Gait10dof18musc_subject01.osim", 12, 10, 39, 72.6},
    {"muscle_lengths_opensim/walk_gait1018_subject01.osim", 12, 10, 39, 72.6},
    {"muscle_lengths_opensim/subject_walk_armless_18musc.osim", 14, 25, 0, 92.3828},
    {"walking_emg/gait2392.osim", 12, 23, 35, 75.1646},
};

std::string MessageOf(const std::string& text) {
  const auto read = ReadOsim(text, "m.osim");
  if (!read) return read.error().message;
  const auto built = MultibodyModel::Build(*read);
  return built ? "" : built.error().message;
}

long LineWith(const std::string& text, const std::string& what) {
  return 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find(what)), '\n');
}

std::string At(long line) {
  return "m.osim:" + std::to_string(line) + ": ";
}

TEST(ReadOsim, ReadsEverySharedModel) {
  if (ReadText(kGaitModel).empty()) GTEST_SKIP() << "no shared data at " << kSharedData;
  constexpr double kPrintedDigits = 1e-4;  // of the masses above
  for (const SharedModel& expected : kSharedModels) {
    SCOPED_TRACE(expected.path);
    const auto read = ReadOsim(ReadText(kSharedData + "/" + expected.path), expected.path);
    ASSERT_TRUE(read) << read.error().message;
    const auto built = MultibodyModel::Build(*read);
    ASSERT_TRUE(built) << built.error().message;
    EXPECT_EQ(read->bodies.size(), expected.bodies);
    EXPECT_EQ(built->coordinate_names().size(), expected.coordinates);
    EXPECT_EQ(built->marker_names().size(), expected.markers);
    EXPECT_NEAR(built->total_mass_kg(), expected.mass_kg, kPrintedDigits);
    EXPECT_TRUE(built->notes().empty());
  }
}

TEST(ReadOsim, ReadsTheGaitModelInBothDialectsAlike) {
  const std::string old_dialect =
      ReadText(kSharedData + "/muscle_lengths_opensim/walk_gait1018_subject01.osim");
  if (old_dialect.empty()) GTEST_SKIP() << "no shared data at " << kSharedData;
  const MultibodyModel old_model = BuildModel(old_dialect);
  const MultibodyModel new_model = BuildModel(ReadText(kGaitModel));
  ASSERT_EQ(old_model.coordinate_names(), new_model.coordinate_names());
  const Vector values = Vector::LinSpaced(10, -0.4, 0.5);
  const auto old_markers = *old_model.MarkerPositions(values);
  const auto new_markers = *new_model.MarkerPositions(values);
  ASSERT_EQ(old_markers.size(), new_markers.size());
  constexpr double kPrintedDigits = 1e-6;  // metres; the newer file prints offsets with six digits
  const Vec3 shift(0, 0, 0.02);            // the older file's constant in the pelvis's third translation
  for (std::size_t i = 0; i < old_markers.size(); ++i) {
    EXPECT_NEAR((old_markers[i] - new_markers[i] - shift).norm(), 0, kPrintedDigits)
        << old_model.marker_names()[i];
  }
}

TEST(ReadOsim, ReadsCouplersLocksAndKindsOfMotion) {
  const std::string text = ReadText(kSharedData + "/muscle_lengths_opensim/subject_walk_armless_18musc.osim");
  if (text.empty()) GTEST_SKIP() << "no shared data at " << kSharedData;
  const auto read = *ReadOsim(text, "armless");
  ASSERT_EQ(read.couplers.size(), 2U);
  EXPECT_EQ(read.couplers[0].independent, "knee_angle_r");
  EXPECT_EQ(read.couplers[0].dependent, "knee_angle_r_beta");
  const MultibodyModel model = BuildModel(text);
  EXPECT_TRUE(model.coordinate(*model.CoordinateIndex("subtalar_angle_r")).locked);
  EXPECT_TRUE(model.IsRotational("knee_angle_r"));
  EXPECT_FALSE(model.IsRotational("pelvis_ty"));
  EXPECT_FALSE(model.IsRotational("knee_angle_r_beta"));
  EXPECT_TRUE(model.IsAngle("knee_angle_r_beta"));
  EXPECT_TRUE(model.IsAngle("knee_angle_r"));
  EXPECT_FALSE(model.IsAngle("pelvis_ty"));
  EXPECT_FALSE(model.IsRotational("no_such_coordinate"));
  EXPECT_TRUE(model.IsDependent(*model.CoordinateIndex("knee_angle_r_beta")));
}

TEST(ReadOsim, ReadsPropertiesOfCoordinatesAndBodies) {
  for (const std::string& text : {PendulumText3(), PendulumText4()}) {
    const auto read = *ReadOsim(text, "m.osim");
    EXPECT_EQ(read.name, "pendulum");
    EXPECT_EQ(read.gravity, Vec3(0, -9.81, 0));
    ASSERT_EQ(read.bodies.size(), 2U);
    EXPECT_EQ(read.bodies[0].mass_kg, 2);
    EXPECT_EQ(read.bodies[0].mass_center, Vec3(0, -0.25, 0));
    EXPECT_EQ(read.bodies[0].inertia(1, 1), 0.001);
    const auto shoulder = std::find_if(read.joints.begin(), read.joints.end(),
                                       [](const OsimJoint& joint) { return joint.name == "shoulder"; });
    ASSERT_NE(shoulder, read.joints.end());
    EXPECT_EQ(shoulder->type, "PinJoint");
    EXPECT_EQ(shoulder->coordinates[0].default_value, 0.3);
    EXPECT_EQ(shoulder->coordinates[0].lower, -3);
    EXPECT_EQ(shoulder->coordinates[0].upper, 3);
    EXPECT_TRUE(shoulder->coordinates[0].clamped);
    EXPECT_FALSE(shoulder->coordinates[0].locked);
  }
}

TEST(ReadOsim, NamesTheLineOfAnUnsupportedJoint) {
  for (const std::string& good : {PendulumText3(), PendulumText4()}) {
    std::string bad = Replaced(good, "<PinJoint", "<EllipsoidJoint");
    bad = Replaced(bad, "</PinJoint", "</EllipsoidJoint");
    EXPECT_THAT(MessageOf(bad), AllOf(StartsWith(At(LineWith(bad, "<EllipsoidJoint"))),
                                      HasSubstr("EllipsoidJoint 'shoulder' is not supported; supported are"),
                                      HasSubstr("PinJoint")));
  }
}

TEST(ReadOsim, NamesTheLineOfAnUnsupportedFunction) {
  std::string bad = Replaced(PendulumText4(), "<LinearFunction", "<Sine");
  bad = Replaced(bad, "</LinearFunction", "</Sine");
  EXPECT_THAT(MessageOf(bad), AllOf(StartsWith(At(LineWith(bad, "<Sine"))), HasSubstr("function Sine is not"),
                                    HasSubstr("SimmSpline")));
}

TEST(ReadOsim, RejectsUnsupportedParts) {
  EXPECT_THAT(MessageOf(Replaced(PendulumText3(), "<reverse>false", "<reverse>true")),
              HasSubstr("joint 'shoulder' is reversed"));
  EXPECT_THAT(MessageOf(Replaced(kLeg, "<PointConstraint name=\"unused\"><isEnforced>false",
                                 "<PointConstraint name=\"unused\"><isEnforced>true")),
              HasSubstr("PointConstraint 'unused' is not supported"));
  EXPECT_THAT(MessageOf(Replaced(kLeg, ">knee</independent", ">knee hip_x</independent")),
              HasSubstr("supported is one"));
  EXPECT_THAT(MessageOf(Replaced(PendulumText3(), "Version=\"30000\"", "Version=\"10500\"")),
              HasSubstr("older than OpenSim 2.0"));
  EXPECT_THAT(MessageOf(Replaced(PendulumText4(), "<coordinates>elbow_angle</coordinates>",
                                 "<coordinates>elbow_angle elbow_angle</coordinates>")),
              HasSubstr("depends on 2 coordinates"));
}

TEST(ReadOsim, RejectsMissingAndUnknownNames) {
  EXPECT_THAT(MessageOf(Replaced(PendulumText3(), "<parent_body>upper</parent_body>", "")),
              HasSubstr("joint 'elbow' of body 'lower' has no parent_body"));
  EXPECT_THAT(MessageOf(Replaced(PendulumText3(), "<parent_body>upper<", "<parent_body>uper<")),
              HasSubstr("there is no body or frame 'uper'; did you mean 'upper'?"));
  EXPECT_THAT(
      MessageOf(Replaced(PendulumText4(), "<socket_parent_frame>ground_offset</socket_parent_frame>", "")),
      HasSubstr("PinJoint 'shoulder' has no socket_parent_frame"));
  EXPECT_THAT(
      MessageOf(Replaced(PendulumText4(), "<socket_parent>upper_end<", "<socket_parent>upper_offset<")),
      HasSubstr("is attached to itself"));
  EXPECT_THAT(MessageOf(Replaced(PendulumText4(), "<coordinates>elbow_angle<", "<coordinates>elbow<")),
              HasSubstr("depends on 'elbow', which the joint lacks"));
  EXPECT_THAT(
      MessageOf(Replaced(kLeg, "<dependent_coordinate_name>knee_beta", "<dependent_coordinate_name>kne")),
      HasSubstr("names coordinate 'kne', which the model lacks; did you mean 'knee'?"));
  EXPECT_THAT(MessageOf(Replaced(PendulumText4(), "Body name=\"lower\"", "Body name=\"upper\"")),
              HasSubstr("two bodies named 'upper'"));
  EXPECT_THAT(MessageOf(Replaced(PendulumText4(), "Marker name=\"joint\"", "Marker name=\"tip\"")),
              HasSubstr("two markers named 'tip'"));
}

TEST(ReadOsim, RejectsBadNumbers) {
  const std::string text = PendulumText4();
  EXPECT_THAT(MessageOf(Replaced(text, "<mass>2<", "<mass>two<")),
              HasSubstr("mass is 'two', expected a number"));
  EXPECT_THAT(MessageOf(Replaced(text, "<mass>2<", "<mass>-2<")),
              HasSubstr("is -2 kg, expected a number from"));
  EXPECT_THAT(MessageOf(Replaced(text, "<mass>2<", "<mass>2e80<")),
              HasSubstr("mass of body 'upper' is 2e+80 kg, expected a number from 0 to 1000000"));
  EXPECT_THAT(MessageOf(Replaced(text, "<mass_center>0 -0.25 0<", "<mass_center>0 -2500 0<")),
              HasSubstr("mass_center of body 'upper' is 2500 m from its origin, expected at most 1000"));
  EXPECT_THAT(MessageOf(Replaced(text, "<inertia>0.05 0.001 0.05 0 0 0<", "<inertia>0.05 0.001<")),
              HasSubstr("inertia has 2 value(s), expected six"));
  EXPECT_THAT(MessageOf(Replaced(text, "<translation>0 1 0<", "<translation>0 1<")),
              HasSubstr("translation has 2 value(s), expected three numbers"));
  EXPECT_THAT(MessageOf(Replaced(text, "<range>-3 3<", "<range>3 -3<")), HasSubstr("range of coordinate"));
  EXPECT_THAT(MessageOf(Replaced(text, "<axis>0 1 0<", "<axis>1 0 0<")), HasSubstr("parallel or zero"));
  EXPECT_THAT(MessageOf(Replaced(text, "<clamped>true<", "<clamped>maybe<")),
              HasSubstr("expected true or false"));
  EXPECT_THAT(MessageOf(Replaced(text, "<coefficients> 1 0<", "<coefficients> 1 0 2<")),
              HasSubstr("LinearFunction has 3 coefficient(s)"));
  EXPECT_THAT(MessageOf(Replaced(kLeg, "<x>-2.1 -1.2", "<x>-2.1 -3.2")),
              HasSubstr("SimmSpline x does not increase at point 2"));
}

TEST(ReadOsim, RejectsWhatIsNotAModel) {
  EXPECT_THAT(MessageOf(""), StartsWith(At(1)));
  EXPECT_THAT(MessageOf("time\tx\n0\t1\n"), HasSubstr("not well-formed XML"));
  EXPECT_THAT(MessageOf("<a><b/></a>"), HasSubstr("expected <OpenSimDocument>"));
  EXPECT_THAT(MessageOf("<OpenSimDocument/>"), HasSubstr("Version ''"));
  EXPECT_THAT(MessageOf("<OpenSimDocument Version=\"40000\"/>"), HasSubstr("there is no <Model>"));
  EXPECT_THAT(MessageOf("<OpenSimDocument Version=\"40000\"><Model/></OpenSimDocument>"),
              HasSubstr("the model has no bodies"));
  const std::string broken = Replaced(PendulumText3(), "</MarkerSet>", "</MarkersSet>");
  EXPECT_THAT(MessageOf(broken),
              AllOf(StartsWith(At(LineWith(broken, "</MarkersSet"))), HasSubstr("well-formed")));
}

TEST(ReadOsim, RejectsBodiesThatDoNotFormATree) {
  EXPECT_THAT(
      MessageOf(Replaced(PendulumText4(), "frame>/bodyset/upper</socket_child", "frame>lower</socket_child")),
      HasSubstr("body 'lower' is moved by joints 'elbow' and 'shoulder'"));
  EXPECT_THAT(
      MessageOf(Replaced(PendulumText4(), "<socket_parent>/ground<", "<socket_parent>/bodyset/lower<")),
      HasSubstr("hangs in a loop that never reaches ground"));
  EXPECT_THAT(MessageOf(Replaced(PendulumText3(), "<parent_body>ground<", "<parent_body>lower<")),
              HasSubstr("hangs in a loop"));
  const std::string lone = "<Body name=\"lone\"/></objects></BodySet>";
  EXPECT_THAT(MessageOf(Replaced(PendulumText4(), "</objects></BodySet>", lone)),
              HasSubstr("body 'lone' has no joint"));
}

// The left hip of some models turns by -1 times its angle; a motion file gives it in degrees all the same.
TEST(ReadOsim, AnAngleMayTurnBackwards) {
  const std::string slope = "<coefficients> 1 0</coefficients>";
  const auto is_rotational = [&](const std::string& coefficients) {
    return BuildModel(Replaced(PendulumText3(), slope, "<coefficients>" + coefficients + "</coefficients>"))
        .IsRotational("elbow_angle");
  };
  EXPECT_TRUE(is_rotational("-1 0"));
  EXPECT_FALSE(is_rotational("2 0"));
}

// Arbitrary bytes give a model or an error, never a crash.
TEST(ReadOsim, SurvivesDamagedFiles) {
  constexpr int kRounds = 4000;
  const std::string texts[] = {PendulumText3(), PendulumText4(), kLeg};
  Random random(20240117);
  int accepted = 0;
  int rejected = 0;
  for (int round = 0; round < kRounds; ++round) {
    const std::string& text = texts[random.Index(3)];
    (MessageOf(Damaged(text, random)).empty() ? accepted : rejected) += 1;
  }
  // Both outcomes occurred.
  EXPECT_GT(accepted, kRounds / 20);
  EXPECT_GT(rejected, kRounds / 20);
}

TEST(ReadOsim, SurvivesTruncation) {
  const std::string text = PendulumText4();
  for (std::size_t length = 0; length + 20 < text.size(); length += 7)
    EXPECT_THAT(MessageOf(text.substr(0, length)), StartsWith("m.osim:")) << length;
}

}  // namespace
}  // namespace sinew
