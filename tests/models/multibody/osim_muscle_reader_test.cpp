#include "models/multibody/osim_muscle_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "models/multibody/muscle_geometry.h"
#include "tests/models/multibody/damaged_text.h"
#include "tests/models/multibody/test_muscles.h"

namespace sinew {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::MatchesRegex;

const std::string kText = MusclesOver("drum");

Result<std::vector<OsimMusclePath>> Read(const std::string& text, const std::vector<std::string>& muscles) {
  return ReadOsimMuscles(text, "test.osim", *ReadOsim(kText, "test.osim"), muscles);
}

std::string ErrorOf(const std::string& text, const std::string& muscle) {
  const auto read = Read(text, {muscle});
  return read ? "no error" : read.error().message;
}

TEST(OsimMuscleReader, ListsWhateverHasAPath) {
  const auto names = ListOsimMuscles(kText, "test.osim");
  ASSERT_TRUE(names);
  EXPECT_THAT(*names, ElementsAre("around", "helix", "through", "sliding", "coupled"));
}

TEST(OsimMuscleReader, ReadsPointsAndWraps) {
  const auto read = Read(MusclesOver("drum", "-X", "0.4", "1 2"), {"through", "around", "sliding"});
  ASSERT_TRUE(read) << read.error().message;
  const OsimMusclePath& through = (*read)[0];
  ASSERT_EQ(through.points.size(), 3U);
  EXPECT_EQ(through.points[1].location, Vec3(0.1, 0.1, 0));
  ASSERT_TRUE(through.points[1].condition);
  EXPECT_EQ(through.points[1].condition->coordinate, "angle");
  EXPECT_EQ(through.points[1].condition->upper, 2);
  const OsimMusclePath& around = (*read)[1];
  ASSERT_EQ(around.wraps.size(), 1U);
  const OsimWrapObject& drum = around.wraps[0].object;
  EXPECT_EQ(drum.shape, WrapShape::kCylinder);
  EXPECT_EQ(drum.frame.body, "ground");
  EXPECT_EQ(drum.length, 0.4);
  EXPECT_EQ(drum.side_axis, 0);
  EXPECT_EQ(drum.side, -1);
  EXPECT_EQ(around.wraps[0].last, 1);
  ASSERT_TRUE((*read)[2].points[1].motion);
  EXPECT_EQ((*(*read)[2].points[1].motion)[0].function.At(1).value, 0.1 + 0.2 + 0.3);
}

TEST(OsimMuscleReader, TwoMusclesOfOneNameAreAnErrorOfTheFile) {
  const std::string twice = Replaced(MusclesOver("drum"), "name=\"sliding\"", "name=\"through\"");
  const std::string message = "test.osim:53: there are two muscles named 'through'";
  const auto names = ListOsimMuscles(twice, "test.osim");
  ASSERT_FALSE(names);
  EXPECT_EQ(names.error().message, message);
  const auto read = Read(twice, {"through"});
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().message, message);
  EXPECT_TRUE(Read(twice, {"around"})) << "a muscle that is not read may be named twice";
}

TEST(OsimMuscleReader, ReadsOpenSim4) {
  const std::string text = ReadText(kSharedData + "/walking_emg/gait2392.osim");
  if (text.empty()) GTEST_SKIP() << "no " << kSharedData << "/walking_emg";
  const auto model = ReadOsim(text, "gait2392.osim");
  const auto names = ListOsimMuscles(text, "gait2392.osim");
  ASSERT_TRUE(model && names);
  EXPECT_EQ(names->size(), 92U);
  const auto paths = ReadOsimMuscles(text, "gait2392.osim", *model, *names);
  ASSERT_TRUE(paths) << paths.error().message;
  std::size_t conditional = 0;
  std::size_t moving = 0;
  for (const OsimMusclePath& path : *paths) {
    for (const OsimPathPoint& point : path.points) {
      conditional += point.condition ? 1U : 0U;
      moving += point.motion ? 1U : 0U;
    }
  }
  EXPECT_EQ(conditional, 26U);
  EXPECT_EQ(moving, 8U);
}

TEST(OsimMuscleReader, PointsAndObjectsOnOffsetFrames) {
  const std::string text = R"(<OpenSimDocument Version="40000"><Model name="m">
<Ground name="ground"/>
<BodySet><objects><Body name="leg"><mass>1</mass><inertia>1 1 1 0 0 0</inertia>
  <components><PhysicalOffsetFrame name="heel"><socket_parent>..</socket_parent><translation>0 0 1</translation>
    <orientation>0 0 1.5707963267948966</orientation>
    <WrapObjectSet name="wraps"><objects><WrapSphere name="ball"><translation>2 0 0</translation><radius>0.1</radius></WrapSphere>
    </objects></WrapObjectSet></PhysicalOffsetFrame></components></Body></objects></BodySet>
<JointSet><objects><WeldJoint name="w"><socket_parent_frame>/ground</socket_parent_frame>
  <socket_child_frame>/bodyset/leg</socket_child_frame></WeldJoint></objects></JointSet>
<ForceSet name="forceset"><objects><Millard2012EquilibriumMuscle name="m"><GeometryPath name="path"><PathPointSet><objects>
  <PathPoint name="a"><socket_parent_frame>/bodyset/leg/heel</socket_parent_frame><location>1 0 0</location></PathPoint>
  <PathPoint name="b"><socket_parent_frame>/ground</socket_parent_frame></PathPoint></objects></PathPointSet>
  <PathWrapSet><objects><PathWrap><wrap_object>ball</wrap_object></PathWrap></objects></PathWrapSet>
</GeometryPath></Millard2012EquilibriumMuscle></objects></ForceSet></Model></OpenSimDocument>)";
  const auto model = ReadOsim(text, "m.osim");
  ASSERT_TRUE(model) << model.error().message;
  const auto read = ReadOsimMuscles(text, "m.osim", *model, {"m"});
  ASSERT_TRUE(read) << read.error().message;
  const OsimFrame& frame = (*read)[0].points[0].frame;
  EXPECT_EQ(frame.body, "leg");
  EXPECT_LT((frame.location + frame.rotation * Vec3(1, 0, 0) - Vec3(0, 1, 1)).norm(), 1e-15);
  const OsimFrame& ball = (*read)[0].wraps[0].object.frame;
  EXPECT_EQ(ball.body, "leg");
  EXPECT_LT((ball.location - Vec3(0, 2, 1)).norm(), 1e-15);
}

TEST(OsimMuscleReader, WrongInputIsAnErrorWithItsLine) {
  EXPECT_EQ(ErrorOf(kText, "helyx"), "test.osim: there is no muscle 'helyx'; did you mean 'helix'?");
  EXPECT_EQ(Read(kText, {"helix", "helix"}).error().message, "muscle 'helix' is asked for twice");
  const std::string line = "test\\.osim:[0-9]+: ";
  EXPECT_THAT(ErrorOf(MusclesOver("egg"), "around"),
              MatchesRegex(line + "muscle 'around' wraps over WrapEllipsoid 'egg', which is not supported; "
                                  "supported are WrapCylinder, WrapSphere"));
  EXPECT_EQ(ErrorOf(MusclesOver("egg"), "helix"), "no error");  // only what is asked for is looked at
  EXPECT_THAT(
      ErrorOf(MusclesOver("dram"), "around"),
      MatchesRegex(line + "muscle 'around' wraps over 'dram', which the model lacks; did you mean 'drum'."));
  EXPECT_THAT(ErrorOf(MusclesOver("drum", "left"), "around"),
              MatchesRegex(line + "quadrant of WrapCylinder 'drum' is 'left', expected all, x, .*"));
  EXPECT_THAT(ErrorOf(MusclesOver("drum", "all", "-1"), "around"),
              MatchesRegex(line + "length of WrapCylinder 'drum' is -1 m, expected a number > 0"));
  EXPECT_THAT(ErrorOf(MusclesOver("drum", "all", "long"), "around"), MatchesRegex(line + ".*long.*"));
  for (const std::string range : {"1", "2 1", "1 3", "1.5 2", "nan 2", "1 1e300"}) {
    EXPECT_THAT(ErrorOf(MusclesOver("drum", "all", "1", range), "around"),
                MatchesRegex(line + "range of the wrap over 'drum' of muscle 'around' is '" + range +
                             "', expected .*"));
  }
  EXPECT_THAT(ErrorOf(Replaced(kText, "<location>0 0.4 0</location><body>ground</body>",
                               "<location>0 0.4 0</location><body>grund</body>"),
                      "through"),
              MatchesRegex(line + "there is no body or frame 'grund'; did you mean 'ground'."));
  EXPECT_THAT(
      ErrorOf(Replaced(kText, "<location>0 0.4 0</location>", "<location>0 x 0</location>"), "through"),
      MatchesRegex(line + ".*x.*"));
  EXPECT_THAT(
      ErrorOf(Replaced(kText, "<range>1 2</range><coordinate>", "<range>2 1</range><coordinate>"), "through"),
      MatchesRegex(line + "range of ConditionalPathPoint 'via' is '2 1', expected .*"));
  EXPECT_THAT(
      ErrorOf(Replaced(kText, "<coordinate>angle<", "<coordinate>angel<"), "through"),
      MatchesRegex(line + "ConditionalPathPoint 'via' names coordinate 'angel', which the model lacks.*"));
  EXPECT_THAT(
      ErrorOf(Replaced(kText, "<ConditionalPathPoint name=\"via\">", "<PathPoint name=\"via\">"), "through"),
      HasSubstr("test.osim:"));
  EXPECT_THAT(ErrorOf(Replaced(kText, "<x_location>", "<no_location>"), "sliding"), HasSubstr("test.osim:"));
  EXPECT_THAT(Read("<OpenSimDocument Version=\"40000\"/>", {}).error().message,
              HasSubstr("there is no <Model>"));
}

// A whole model: one error lists every muscle that is not supported.
TEST(OsimMuscleReader, NamesEverythingThatIsNotSupported) {
  const std::string text =
      Replaced(MusclesOver("egg"), "<ConditionalPathPoint name=\"via\">", "<StrangePoint name=\"via\">");
  const std::string damaged = Replaced(text, "</ConditionalPathPoint>", "</StrangePoint>");
  const auto model = ReadOsim(kText, "test.osim");
  const auto unsupported =
      ListUnsupportedMuscles(damaged, "test.osim", *model, {"helix", "around", "through", "absent"});
  ASSERT_TRUE(unsupported) << unsupported.error().message;
  ASSERT_EQ(unsupported->size(), 2U);
  EXPECT_EQ((*unsupported)[0].muscle, "around");
  EXPECT_EQ((*unsupported)[0].part, "WrapEllipsoid 'egg'");
  EXPECT_GT((*unsupported)[0].line, 1);
  EXPECT_EQ((*unsupported)[1].part, "StrangePoint 'via'");
  EXPECT_THAT(
      Read(damaged, {"around", "through"}).error().message,
      testing::EndsWith("supported are WrapCylinder, WrapSphere; 2 muscles have a part that is not: around "
                        "(WrapEllipsoid 'egg'), through (StrangePoint 'via')"));
}

// Arbitrary bytes give muscles or an error, never a crash, also for a path that was accepted.
TEST(OsimMuscleReader, SurvivesDamagedFiles) {
  constexpr int kRounds = 3000;
  const std::string texts[] = {kText, MusclesOver("ball", "-x", "0.1", "1 2"), MusclesOver("drum", "z")};
  const std::vector<std::string> muscles{"around", "helix", "through", "sliding", "coupled"};
  const MultibodyModel model = BuildModel(kText);
  const Vector bent = Vector::Constant(2, 2.5);
  Random random(20240118);
  int accepted = 0;
  int rejected = 0;
  for (int round = 0; round < kRounds; ++round) {
    const std::string text = Damaged(texts[random.Index(3)], random);
    const auto paths = Read(text, muscles);
    (paths ? accepted : rejected) += 1;
    if (!paths) {
      EXPECT_THAT(paths.error().message, testing::StartsWith("test.osim:"));
      continue;
    }
    const auto geometry = MuscleGeometry::Build(model, *paths);
    if (!geometry) continue;
    const auto state = geometry->At(bent, bent, {});
    EXPECT_TRUE(!state || state->lengths.size() == 5);
  }
  EXPECT_GT(accepted, kRounds / 20);
  EXPECT_GT(rejected, kRounds / 20);
}

}  // namespace
}  // namespace sinew
