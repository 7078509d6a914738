// Recordings whose signs, units or zeros are not those that they are said to have.
#include "problems/drive/data/conventions.h"

#include <gmock/gmock.h>

#include "base/constants.h"
#include "base/random.h"
#include "problems/drive/data/data.h"
#include "tests/problems/support/drive_bench.h"

namespace sinew {
namespace {

using Values = std::map<std::string, double>;

constexpr double kReadingNoise = 0.002;  // [rad or m]

Channel& ChannelOf(Dataset& data, const std::string& name) {
  return data.trials.at("swing").grids.at("joint").channels.at(name);
}

void Multiply(Dataset& data, const std::string& channel, double factor) {
  for (double& value : ChannelOf(data, channel).values) value *= factor;
}

Bench Driven() {
  Bench bench;
  bench.duration = 12;
  bench.command = [](double t) { return 0.5 * std::sin(2 * t) + 0.3 * std::sin(5.3 * t); };
  return bench;
}

const Values kPendulum = {{"inertia", 0.043},
                          {"viscous_friction", 0.05},
                          {"gravity_torque", 0.55},
                          {"coulomb_torque", 0.03},
                          {"initial_position@swing", 0.3}};

// What a joint with these values does, and noise.
Dataset Recorded(const Bench& bench, const Values& values) {
  Dataset data = BenchData(bench);
  const auto problem = BindDriveData(data);
  EXPECT_TRUE(problem) << problem.error().message;
  const Vector motion = PredictDrive(**problem, DrivePoint(**problem, values)).Values("position");
  auto& position = ChannelOf(data, "position").values;
  Random random(7);
  for (std::size_t i = 0; i < position.size(); ++i)
    position[i] = motion[static_cast<Eigen::Index>(i)] + kReadingNoise * random.Normal();
  return data;
}

DriveData Prepared(const Dataset& data) {
  const auto yaml = YamlReader::Parse(data.files.at("drive.yaml"), "drive.yaml");
  const auto settings = ReadDriveSettings(*yaml);
  auto prepared = PrepareDriveData(data, *settings, 0);
  EXPECT_TRUE(prepared) << prepared.error().message;
  return std::move(*prepared);
}

DriveConventions Judged(const Dataset& data) {
  return Prepared(data).conventions;
}

void ExpectNothing(const DriveConventions& found) {
  EXPECT_FALSE(found.interval);
  EXPECT_FALSE(found.opposite_input);
  EXPECT_FALSE(found.angle_unit);
  EXPECT_FALSE(found.hangs_at);
}

TEST(DriveConventions, AreThoseOfARightRecording) {
  ExpectNothing(Judged(Recorded(Driven(), kPendulum)));
  EXPECT_THAT(Prepared(Recorded(Driven(), kPendulum)).notes, testing::IsEmpty());
  Bench axis = Driven();
  axis.rotary = false;
  axis.input = "force";
  axis.input_unit = "N";
  ExpectNothing(
      Judged(Recorded(axis, {{"inertia", 0.2}, {"viscous_friction", 0.4}, {"coulomb_torque", 0.1}})));
  // Noise contradicts nothing.
  Dataset noise = Recorded(Driven(), kPendulum);
  Random random(3);
  for (double& value : ChannelOf(noise, "position").values) value = random.Normal();
  ExpectNothing(Judged(noise));
}

TEST(DriveConventions, TheInputHasTheOppositeSign) {
  Dataset data = Recorded(Driven(), kPendulum);
  Multiply(data, "torque", -1);
  const DriveData prepared = Prepared(data);
  EXPECT_TRUE(prepared.conventions.opposite_input);
  EXPECT_FALSE(prepared.conventions.angle_unit);
  EXPECT_FALSE(prepared.conventions.hangs_at);
  ASSERT_EQ(prepared.notes.size(), 1U);
  EXPECT_THAT(prepared.notes[0], testing::HasSubstr("moves against 'torque'"));
  // Where the position turned round instead, too: neither is known to be the wrong one.
  data = Recorded(Driven(), kPendulum);
  Multiply(data, "position", -1);
  EXPECT_TRUE(Judged(data).opposite_input);
}

TEST(DriveConventions, DegreesAreNotRadians) {
  Dataset data = Recorded(Driven(), kPendulum);
  Multiply(data, "position", 180 / kPi);
  const DriveConventions found = Judged(data);
  ASSERT_TRUE(found.angle_unit);
  EXPECT_NEAR(*found.angle_unit, kPi / 180, 1e-12);
  EXPECT_FALSE(found.opposite_input);
  // Both at once.
  Multiply(data, "torque", -1);
  EXPECT_TRUE(Judged(data).angle_unit);
  EXPECT_TRUE(Judged(data).opposite_input);
}

TEST(DriveConventions, AJointThatHangsElsewhere) {
  for (const double zero : {-kPi / 2, 1.2, 2.5}) {
    Dataset data = Recorded(Driven(), kPendulum);
    for (double& value : ChannelOf(data, "position").values) value += zero;
    const DriveConventions found = Judged(data);
    ASSERT_TRUE(found.hangs_at) << zero;
    EXPECT_NEAR(*found.hangs_at, zero, 0.1);
    EXPECT_FALSE(found.opposite_input) << zero;
  }
  // Upright at 0: a negative gravity_torque.
  Dataset data = Recorded(Driven(), kPendulum);
  for (double& value : ChannelOf(data, "position").values) value += kPi;
  ExpectNothing(Judged(data));
}

// A spring that rests far from 0 pulls as gravity about another zero does, over some range.
TEST(DriveConventions, ASpringMayHoldIt) {
  Values values = kPendulum;
  values["gravity_torque"] = 0.02;
  values["spring_stiffness"] = 0.5;
  values["offset_torque"] = 0.5;
  const DriveConventions found = Judged(Recorded(Driven(), values));
  EXPECT_FALSE(found.opposite_input);
  EXPECT_FALSE(found.angle_unit);
  EXPECT_FALSE(found.hangs_at && found.by_gravity);
}

TEST(DriveConventions, TimesInMilliseconds) {
  Dataset data = Recorded(Driven(), kPendulum);
  for (double& t : data.trials.at("swing").grids.at("joint").time) t *= 1000;
  const DriveConventions found = Judged(data);
  ASSERT_TRUE(found.interval);
  EXPECT_NEAR(*found.interval, 10, 1e-9);
}

TEST(DriveConventions, WhatFollowsAReference) {
  Bench servo = Driven();
  servo.input = "reference";
  servo.input_unit = "rad";
  servo.settings = "controller: {kind: servo}";
  servo.constants = {{"supply_voltage", 7.4}, {"kp", 400}};
  Dataset data = Recorded(
      servo,
      {{"inertia", 0.01}, {"viscous_friction", 0.01}, {"torque_constant", 1}, {"gravity_torque", 0.1}});
  ExpectNothing(Judged(data));
  Multiply(data, "position", 180 / kPi);
  DriveConventions found = Judged(data);
  ASSERT_TRUE(found.angle_unit);
  EXPECT_NEAR(*found.angle_unit, kPi / 180, 1e-12);
  EXPECT_FALSE(found.opposite_input);
  Multiply(data, "position", -kPi / 180);
  found = Judged(data);
  EXPECT_FALSE(found.angle_unit);
  EXPECT_TRUE(found.opposite_input);
  // Numbers of an axis are no angles, however large they are.
  servo.rotary = false;
  servo.input_unit = "m";
  data = Recorded(servo, {{"inertia", 0.01}, {"viscous_friction", 0.01}, {"torque_constant", 1}});
  Multiply(data, "position", 180 / kPi);
  ExpectNothing(Judged(data));
}

}  // namespace
}  // namespace sinew
