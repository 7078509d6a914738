// What a drive asks of data, and what it says when it does not get it.
#include "problems/drive/data/data.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "base/constants.h"
#include "base/random.h"
#include "identify/fit_setup.h"
#include "identify/least_squares.h"
#include "tests/problems/support/drive_bench.h"

namespace sinew {
namespace {

Bench Swing() {
  Bench bench;
  bench.command = [](double t) { return 0.5 * std::sin(3 * t) + 0.2 * std::sin(7 * t); };
  return bench;
}

std::string ErrorOf(const Dataset& data) {
  const auto problem = BindDriveData(data);
  return problem ? "" : problem.error().message;
}

Grid& Joint(Dataset& data) {
  return data.trials["swing"].grids["joint"];
}

TEST(DriveData, NamesWhatIsMissing) {
  Dataset data = BenchData(Swing());
  Joint(data).channels.erase("torque");
  EXPECT_EQ(
      ErrorOf(data),
      "trial 'swing' has no input: expected a channel of kind input named torque, force, voltage, duty, "
      "reference");
  data = BenchData(Swing());
  Joint(data).channels["torque"].kind = ChannelKind::kMeasured;
  EXPECT_EQ(
      ErrorOf(data),
      "trial 'swing' channel 'torque' is marked measured, not input; if it drives the joint, import it with "
      "kind: input");
  data = BenchData(Swing());
  Joint(data).channels["voltage"] = {"V", ChannelKind::kInput, {}, Joint(data).channels["torque"].values};
  EXPECT_EQ(ErrorOf(data), "trial 'swing' has 2 inputs (torque, voltage), expected exactly one");
  data = BenchData(Swing());
  Joint(data).channels.erase("position");
  EXPECT_EQ(ErrorOf(data),
            "no trial has a measured position [rad or m] or speed [rad/s or m/s]: nothing to fit");
}

bool HasEffect(const Problem& problem, const std::string& name) {
  return std::any_of(problem.effects().begin(), problem.effects().end(),
                     [&](const Effect& effect) { return effect.name == name; });
}

// The same swing twice, cold and warm.
Dataset TwoSwings() {
  Dataset data = BenchData(Swing());
  const std::size_t count = Joint(data).time.size();
  Joint(data).channels["temperature"] = {"K", ChannelKind::kInput, {}, std::vector<double>(count, 293.15)};
  data.trials["warm"] = data.trials["swing"];
  data.trials["warm"].grids["joint"].channels["temperature"].values.assign(count, 303.15);
  return data;
}

TEST(DriveData, FrictionDependsOnTemperatureOnlyIfEveryTrialHasOne) {
  EXPECT_FALSE(HasEffect(*BindBench(Swing()), "friction_with_temperature"));
  Dataset data = TwoSwings();
  auto problem = BindDriveData(data);
  ASSERT_TRUE(problem) << problem.error().message;
  EXPECT_TRUE(HasEffect(**problem, "friction_with_temperature"));
  EXPECT_TRUE((*problem)->data().notes.empty());

  Joint(data).channels["temperature"].kind = ChannelKind::kMeasured;
  problem = BindDriveData(data);
  ASSERT_TRUE(problem) << problem.error().message;
  EXPECT_FALSE(HasEffect(**problem, "friction_with_temperature"));
  EXPECT_EQ((*problem)->data().notes,
            std::vector<std::string>{
                "'temperature' is not used: trial 'swing' has no channel of kind input of that name"});
}

TEST(DriveData, ATemperatureThatIsNotDeterminedIsAnError) {
  Dataset data = TwoSwings();
  Joint(data).channels["temperature"].values[3] = kNaN;
  EXPECT_EQ(
      ErrorOf(data),
      "trial 'swing': input 'temperature' has a gap at t = 0.03 s; the motion after it is not determined: "
      "cut the trial");
  data = TwoSwings();
  Joint(data).channels["temperature"].unit = "1";
  EXPECT_EQ(ErrorOf(data), "trial 'swing': temperature has unit '1', expected K");
}

TEST(DriveData, RejectsUnitsThatMeanNothingHere) {
  Dataset data = BenchData(Swing());
  Joint(data).channels["position"].unit = "V";
  EXPECT_EQ(ErrorOf(data), "trial 'swing': position has unit 'V', expected rad (rotary) or m (linear)");
  data = BenchData(Swing());
  Joint(data).channels["torque"].unit = "N";
  EXPECT_EQ(ErrorOf(data), "input 'torque' has unit 'N', expected N*m for a rotary joint");
}

TEST(DriveData, AGapInAnInputIsAnErrorAndInAnOutputIsLeftOut) {
  Dataset data = BenchData(Swing());
  Joint(data).channels["torque"].values[7] = kNaN;
  EXPECT_EQ(
      ErrorOf(data),
      "trial 'swing': input 'torque' has a gap at t = 0.07 s; the motion after it is not determined: cut the "
      "trial");
  data = BenchData(Swing());
  Joint(data).channels["position"].values[0] = kNaN;
  Joint(data).channels["position"].values[9] = kNaN;
  const auto problem = BindDriveData(data);
  ASSERT_TRUE(problem) << problem.error().message;
  const Block& block = (*problem)->layout()[0];
  EXPECT_EQ(block.predictions(), 401);
  EXPECT_EQ(block.samples(), 399);
  EXPECT_EQ(block.sample[0], 1);
  ASSERT_EQ((*problem)->data().notes.size(), 1U);
  EXPECT_NE((*problem)->data().notes[0].find("2 of 401 samples of 'position'"), std::string::npos);
}

TEST(DriveData, AChannelThatDoesNotVaryIsAnError) {
  Dataset data = BenchData(Swing());
  for (double& q : Joint(data).channels["position"].values) q = 0.3;
  EXPECT_EQ(ErrorOf(data), "channel 'position' does not vary: nothing to fit");
}

TEST(DriveData, AReferenceNeedsItsControllerAndAServoItsSupply) {
  Bench bench = Swing();
  bench.input = "reference";
  bench.input_unit = "rad";
  EXPECT_EQ(ErrorOf(BenchData(bench)),
            "the input is a reference: expected the controller that follows it, under drive.controller");
  bench.settings = "controller: {kind: servo}";
  EXPECT_EQ(ErrorOf(BenchData(bench)),
            "trial 'swing': needs supply_voltage: a constant, a condition of the trial, or a channel of kind "
            "input");
  bench.constants["supply_voltage"] = 7.4;
  EXPECT_EQ(ErrorOf(BenchData(bench)),
            "trial 'swing': the controller has no kp: give it in drive.controller, as a constant or as a "
            "condition");
  bench.constants["kp"] = 400;
  EXPECT_EQ(ErrorOf(BenchData(bench)), "");
  bench = Swing();
  bench.settings = "controller: {kind: servo, kp: 1}";
  EXPECT_EQ(ErrorOf(BenchData(bench)),
            "drive.controller needs the input 'reference', but the trials are driven by 'torque'");
}

Bench Cascade(const std::string& more) {
  Bench bench = Swing();
  bench.input = "reference";
  bench.input_unit = "rad";
  bench.settings = "controller: {kind: cascade, control_period: 0.01" + more + "}";
  return bench;
}

TEST(DriveData, ACascadeNeedsItsGains) {
  const std::string where = ": give it in drive.controller, as a constant or as a condition";
  EXPECT_EQ(ErrorOf(BenchData(Cascade(""))), "trial 'swing': the controller has no position_gain" + where);
  EXPECT_EQ(ErrorOf(BenchData(Cascade(", position_gain: 8"))),
            "trial 'swing': the controller has no velocity_gain" + where);
  const std::string gains = ", position_gain: 8, velocity_gain: 0.4";
  EXPECT_EQ(ErrorOf(BenchData(Cascade(gains))), "");
  EXPECT_EQ(ErrorOf(BenchData(Cascade(", position_gain: 8, velocity_gain: 0"))),
            "trial 'swing': velocity_gain is 0, expected above 0");
  EXPECT_EQ(ErrorOf(BenchData(Cascade(gains + ", velocity_filter: -1"))),
            "trial 'swing': velocity_filter is -1, expected at least 0");
  EXPECT_EQ(ErrorOf(BenchData(Cascade(gains + ", initial_integral: fitted"))),
            "trial 'swing': initial_integral is to be fitted, but velocity_integral is 0: the controller has "
            "no integral");
  EXPECT_EQ(ErrorOf(BenchData(Cascade(gains + ", velocity_integral: 2, initial_integral: fitted"))), "");
}

TEST(DriveData, ADisturbanceNeedsAControllerThatTakesIt) {
  Bench bench = Cascade(", position_gain: 8, velocity_gain: 0.4");
  bench.inputs["disturbance"] = {"V", [](double) { return 0.1; }};
  EXPECT_EQ(ErrorOf(BenchData(bench)),
            "trial 'swing': 'disturbance' has unit 'V', expected N*m, that of the controller's output");
  bench.inputs["disturbance"].unit = "N*m";
  EXPECT_EQ(ErrorOf(BenchData(bench)), "");
  Bench open = Swing();
  open.inputs = bench.inputs;
  EXPECT_EQ(ErrorOf(BenchData(open)),
            "trial 'swing': 'disturbance' is added to the output of a sampled controller (pid_speed, "
            "pid_position, cascade), but the joint is driven by 'torque'");
}

TEST(DriveData, AMotorIsOnOrOff) {
  Bench bench = Swing();
  bench.inputs["motor_on"] = {"1", [](double t) { return t < 1 ? 1.0 : 0.5; }};
  EXPECT_EQ(ErrorOf(BenchData(bench)),
            "trial 'swing': 'motor_on' is 0.5 at t = 1 s, expected 0 (the motor is off) or 1");
  bench.inputs["motor_on"] = {"V", [](double) { return 1.0; }};
  EXPECT_EQ(ErrorOf(BenchData(bench)), "trial 'swing': 'motor_on' has unit 'V', expected 1");
  bench.inputs["motor_on"] = {"1", [](double t) { return t < 1 ? 1.0 : 0.0; }};
  Dataset data = BenchData(bench);
  EXPECT_EQ(ErrorOf(data), "");
  Joint(data).channels["motor_on"].kind = ChannelKind::kMeasured;
  EXPECT_EQ(ErrorOf(data),
            "trial 'swing': channel 'motor_on' is marked measured, not input; import it with kind: input");
}

TEST(DriveData, AllTrialsOrNoneSayWhenTheyBegan) {
  Dataset data = BenchData(Swing());
  data.trials["later"] = data.trials["swing"];
  data.trials["later"].conditions["session_time_s"] = 60;
  EXPECT_EQ(
      ErrorOf(data),
      "trial 'later' has the condition session_time_s, trial 'swing' has not: expected it in all trials "
      "or in none");
  data.trials["swing"].conditions["session_time_s"] = 10;
  const auto problem = BindDriveData(data);
  ASSERT_TRUE(problem) << problem.error().message;
  EXPECT_TRUE(FindParameter((*problem)->parameters(), "session_rate"));
  EXPECT_EQ((*problem)->data().runs[0].session, 50) << "of the trial 'later', since the first began";
  EXPECT_FALSE(FindParameter(BindBench(Swing())->parameters(), "session_rate"));
}

TEST(DriveData, SettingsAreReadStrictly) {
  const auto error = [](const std::string& text) {
    const auto yaml = YamlReader::Parse(text, "drive.yaml");
    const auto settings = ReadDriveSettings(*yaml);
    return settings ? "" : settings.error().message;
  };
  EXPECT_EQ(error("stepp: 1"), "drive.yaml:1: unknown key 'stepp'; did you mean 'step'?");
  EXPECT_EQ(error("step: 0"), "drive.yaml:1: step: 0 s, expected 1e-6 to 1 s");
  EXPECT_EQ(error("fit: [posision]"),
            "drive.yaml:1: fit: channel 'posision' does not exist; did you mean 'position'?");
  EXPECT_EQ(error("most_steps: 0"), "drive.yaml:1: most_steps: 0, expected 1 to 1000000000");
  EXPECT_EQ(error("hold: zer"), "drive.yaml:1: hold: 'zer' does not exist; did you mean 'zero'?");
  EXPECT_EQ(error("{}"), "");
  EXPECT_EQ(error("controller: {kind: cascad}"),
            "drive.yaml:1: kind: 'cascad' does not exist; did you mean 'cascade'?");
  EXPECT_EQ(error("controller: {kind: servo, kp: 1, velocity_gain: 2}"),
            "drive.yaml:1: controller: servo has no 'velocity_gain', expected kp, servo_error_gain");
  EXPECT_THAT(error("controller: {kind: cascade, kp: 1}"),
              testing::HasSubstr("controller: cascade has no 'kp', expected position_gain, velocity_gain"));
  EXPECT_THAT(error("controller: {kind: cascade, positiongain: 1}"),
              testing::HasSubstr("unknown key 'positiongain'; did you mean 'position_gain'?"));
  const auto force = ReadDriveSettings(*YamlReader::Parse("fit: [position, force]", "drive.yaml"));
  ASSERT_TRUE(force) << force.error().message;
  EXPECT_EQ(force->fit, (std::vector<std::string>{"position", "torque"})) << "they name the same";
  const auto output =
      ReadDriveSettings(*YamlReader::Parse("controller: {kind: pid_position, output: force}", "drive.yaml"));
  ASSERT_TRUE(output) << output.error().message;
  EXPECT_FALSE(output->controller.gives_voltage);
}

TEST(DriveData, AConstantFixesTheParameterOfItsName) {
  Bench bench = Swing();
  bench.constants["inertia"] = 0.05;
  const auto problem = BindBench(bench);
  EXPECT_FALSE(FindParameter(problem->parameters(), "inertia"));
  EXPECT_TRUE(FindParameter(problem->parameters(), "inertia_error"));
  EXPECT_FALSE(FindParameter(BindBench(Swing())->parameters(), "inertia_error"));
}

TEST(DriveData, TheInputMayBeLongerAndSampledOtherwise) {
  Dataset data = BenchData(Swing());
  Grid& fast = data.trials["swing"].grids["bus"];
  for (int i = -500; i <= 4500; ++i) fast.time.push_back(i / 1000.0);
  Channel& torque = fast.channels["torque"];
  torque = Joint(data).channels["torque"];
  torque.values.clear();
  for (const double t : fast.time) torque.values.push_back(std::sin(3 * t));
  Joint(data).channels.erase("torque");
  const auto bare = BindDriveData(data);
  const auto wide = BindDriveData(data, 0.1);
  ASSERT_TRUE(bare && wide);
  EXPECT_EQ((*bare)->layout()[0].prediction_time.front(), 0);
  EXPECT_NEAR((*wide)->layout()[0].prediction_time.front(), -0.1, 1e-9);
  EXPECT_NEAR((*wide)->layout()[0].prediction_time.back(), 4.1, 1e-9);
  EXPECT_EQ((*bare)->layout()[0].measured, (*wide)->layout()[0].measured);
  // The same motion, to the last bit: the margin is integrated through in any case.
  const Vector point = RestPoint(**bare);
  const Vector a = PredictDrive(**bare, point).Values("position");
  const Vector b = PredictDrive(**wide, point).Values("position");
  for (int i = 0; i <= 400; ++i) EXPECT_EQ(a[i], b[(*wide)->layout()[0].sample[static_cast<std::size_t>(i)]]);
}

using Values = std::map<std::string, double>;

// Starts for a joint that has these effects too.
void ExpectStarts(const Bench& bench, const Values& truth, const Values& effects, double tolerance) {
  Dataset data = BenchData(bench);
  const auto maker = BindDriveData(data);
  ASSERT_TRUE(maker);
  auto values = truth;
  values.insert(effects.begin(), effects.end());
  values["initial_position@swing"] = 0.3;
  const Vector motion = PredictDrive(**maker, DrivePoint(**maker, values)).Values("position");
  Joint(data).channels["position"].values.assign(motion.data(), motion.data() + motion.size());
  const auto problem = BindDriveData(data);
  ASSERT_TRUE(problem);
  for (const auto& [name, value] : truth) {
    const int index = FindParameter((*problem)->parameters(), name).value();
    EXPECT_NEAR((*problem)->parameters()[static_cast<std::size_t>(index)].start, value, tolerance * value)
        << name;
  }
}

// Trapezoidal integrals over each window: exact enough on a regular clock, a start on a jittery bus.
TEST(DriveData, StartsComeFromARegression) {
  const Values truth{{"inertia", 0.043}, {"viscous_friction", 0.07}, {"gravity_torque", 0.55}};
  ExpectStarts(Swing(), truth, {}, 0.01);
  Bench jitter = Swing();
  for (int i = 0; i <= 300; ++i) jitter.times.push_back(0.02 * i + 0.004 * std::sin(i));
  ExpectStarts(jitter, truth, {}, 0.3);
}

// A regression without the two gives half of it.
TEST(DriveData, TheInertiaStartsRightBesideDryFrictionAndAnOffset) {
  Bench slow;
  slow.command = [](double t) { return 0.4 * std::sin(1.3 * t); };
  ExpectStarts(slow, {{"inertia", 0.043}},
               {{"viscous_friction", 0.02},
                {"gravity_torque", 0.6},
                {"coulomb_torque", 0.05},
                {"offset_torque", 0.15}},
               0.1);
}

// A spring and the offset that moves its rest take most of the torque; without them in the regression the
// joint's own inertia, of a motor behind a gear, is negative.
TEST(DriveData, BesideAKnownLoadTheOwnInertiaMayBeAlmostAnything) {
  Bench elbow;
  elbow.duration = 8;
  elbow.rate = 200;
  elbow.constants = {{"load_mass", 1.4}, {"load_length", 0.16}};
  elbow.command = [](double t) { return 2.5 + 1.2 * std::sin(2 * t) + 0.7 * std::sin(5 * t); };
  ExpectStarts(
      elbow, {{"inertia", 0.024}},
      {{"drive_gain", 0.94}, {"viscous_friction", 0.33}, {"spring_stiffness", 1.8}, {"offset_torque", 2}},
      0.1);
  const auto problem = BindBench(elbow);
  const int index = FindParameter(problem->parameters(), "inertia").value();
  EXPECT_GE(problem->parameters()[static_cast<std::size_t>(index)].upper, 10 * 1.4 * 0.16 * 0.16);
}

// A regression on noise gives an inertia that is far too small, with which a simulation takes a thousand
// times as many steps: orders of magnitude are used then. Theirs are 0.2 s and 0.1 of torque over speed.
TEST(DriveData, StartsFromNoiseAreOrdersOfMagnitude) {
  Dataset data = BenchData(Swing());
  Random random(1);
  for (double& position : Joint(data).channels["position"].values) position = random.Normal();
  const auto problem = BindDriveData(data);
  ASSERT_TRUE(problem);
  const auto start = [&](const std::string& name) {
    const int index = FindParameter((*problem)->parameters(), name).value();
    return (*problem)->parameters()[static_cast<std::size_t>(index)].start;
  };
  EXPECT_NEAR(start("inertia") / start("viscous_friction"), 2, 1e-9);
}

TEST(DriveData, SignalsAreAtTheSamples) {
  const auto problem = BindBench(Swing());
  const auto signals = problem->ResidualCovariates(0);
  ASSERT_EQ(signals.size(), 3U);
  for (const auto& signal : signals) EXPECT_EQ(signal.values.size(), 401U) << signal.name;
  EXPECT_EQ(signals[0].values[10], problem->layout()[0].measured[10]);
  EXPECT_NEAR(signals[1].values[100], -4 * std::sin(5.0), 0.05);
}

}  // namespace
}  // namespace sinew
