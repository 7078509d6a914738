// Joints under a controller that is known.
#include <gmock/gmock.h>

#include "tests/problems/support/drive_bench.h"

namespace sinew {
namespace {

using testing::DoubleNear;
using testing::Pointwise;

TEST(DriveClosedLoop, TheServoHoldsTheWeightWhereItsTorqueBalancesIt) {
  Bench bench;
  bench.input = "reference";
  bench.input_unit = "rad";
  bench.command = [](double) { return 0.7; };
  bench.duration = 10;
  bench.settings = "controller: {kind: servo, kp: 400}";
  bench.constants = {{"load_mass", 0.5}, {"load_length", 0.1}, {"supply_voltage", 7.4}};
  const auto problem = BindBench(bench);
  const auto answer = PredictDrive(*problem, DrivePoint(*problem, {{"inertia", 0.002},
                                                                   {"viscous_friction", 0.02},
                                                                   {"torque_constant", 0.3},
                                                                   {"resistance", 4.5}}));
  const double q = answer.Values("position")[1000];
  const double duty = 400 * (4096 / (2 * M_PI)) / (256 * 885) * (0.7 - q);
  const double torque = 0.3 / 4.5 * duty * 7.4;
  EXPECT_NEAR(torque, 0.5 * 9.80665 * 0.1 * std::sin(q), 1e-9);
  EXPECT_NEAR(answer.Values("torque")[1000], torque, 1e-9);
  // At first the duty is clipped: the whole supply is on the motor.
  EXPECT_NEAR(answer.Values("current")[0], std::min(1.0, duty / (0.7 - q) * 0.7) * 7.4 / 4.5, 1e-12);
}

Bench SpeedControl() {
  Bench bench;
  bench.input = "reference";
  bench.input_unit = "rad/s";
  bench.settings =
      "controller: {kind: pid_speed, kp: 0.5, ki: 4, kd: 0.002, control_period: 0.01, output_limit: 0.6}";
  return bench;
}

// The same loop, written down once more for a pure inertia, which moves exactly under a held torque.
TEST(DriveClosedLoop, SampledSpeedControlIsItsRecursion) {
  Bench bench = SpeedControl();
  bench.command = [](double t) { return t < 1 ? 2.0 : -1.0; };
  const auto problem = BindBench(bench);
  constexpr double kMass = 0.2;
  const auto answer = PredictDrive(
      *problem, DrivePoint(*problem, {{"inertia", kMass}, {"viscous_friction", 0}, {"gravity_torque", 0}}));
  double v = 0;
  double integral = 0;
  double last = 0;
  bool limited = false;
  for (int i = 0; i <= 400; ++i) {
    const double error = bench.command(i / 100.0) - v;
    double u = 0.5 * error + 4 * (integral + 0.01 * error);
    if (i > 0) u += 0.002 * (error - last) / 0.01;
    if (std::abs(u) <= 0.6 || u * error <= 0) integral += 0.01 * error;
    limited = limited || std::abs(u) > 0.6;
    u = std::min(std::max(u, -0.6), 0.6);
    last = error;
    ASSERT_NEAR(answer.Values("speed")[i], v, 1e-11) << "sample " << i;
    ASSERT_NEAR(answer.Values("torque")[i], u, 1e-11) << "sample " << i;
    v += 0.01 * u / kMass;
  }
  EXPECT_TRUE(limited);
  EXPECT_NEAR(answer.Values("speed")[400], -1, 0.1);  // it settles slowly
}

// The loop of a cascade once more, for a pure inertia; with the motor off from 2 to 2.5 s.
TEST(DriveClosedLoop, ACascadeIsItsRecursion) {
  Bench bench;
  bench.input = "reference";
  bench.input_unit = "rad";
  bench.settings =
      "controller: {kind: cascade, position_gain: 8, velocity_gain: 3, velocity_integral: 10, "
      "velocity_filter: "
      "0.015, velocity_feedforward: 0.7, acceleration_feedforward: 0.1, speed_limit: 1.5, control_period: "
      "0.01, "
      "output_limit: 4, initial_integral: fitted}";
  bench.command = [](double t) { return t < 1 ? 0.2 * t * t : t < 1.5 ? 1.2 : 0.3; };
  bench.inputs["disturbance"] = {"N*m", [](double t) { return 0.3 * std::sin(5 * t); }};
  bench.inputs["motor_on"] = {
      "1", [](double t) { return std::lround(100 * t) < 200 || std::lround(100 * t) >= 250 ? 1.0 : 0.0; }};
  constexpr double kMass = 0.2;
  const auto problem = BindBench(bench);
  const auto answer = PredictDrive(*problem, DrivePoint(*problem, {{"inertia", kMass},
                                                                   {"viscous_friction", 0},
                                                                   {"gravity_torque", 0},
                                                                   {"initial_position@swing", 0.1},
                                                                   {"initial_speed@swing", 0.4},
                                                                   {"initial_integral@swing", 0.25}}));
  double q = 0.1;
  double v = 0.4;
  double sum = 0.25 / 10;  // of the speed error
  double speed = v;        // as the controller estimates it
  double seen = q;
  std::vector<double> wanted;
  bool paced = false;
  bool limited = false;
  for (int i = 0; i <= 400; ++i) {
    const double t = i / 100.0;
    if (i > 0) speed = (0.015 * speed + (q - seen)) / (0.015 + 0.01);
    seen = q;
    wanted.push_back(bench.command(t));
    const auto pace = [&](std::size_t k) { return k == 0 ? 0 : 100 * (wanted[k] - wanted[k - 1]); };
    const auto k = static_cast<std::size_t>(i);
    double target = 8 * (wanted[k] - q) + 0.7 * pace(k);
    paced = paced || std::abs(target) > 1.5;
    target = std::min(std::max(target, -1.5), 1.5);
    const double error = target - speed;
    double u = 3 * error + 10 * (sum + 0.01 * error) + 0.3 * std::sin(5 * t);
    if (i > 1) u += 0.1 * 100 * (pace(k) - pace(k - 1));
    limited = limited || std::abs(u) > 4;
    const bool on = i < 200 || i >= 250;
    if (!on) {
      sum = 0;
      u = 0;
    } else if (std::abs(u) <= 4 || u * error <= 0) {
      sum += 0.01 * error;
    }
    u = std::min(std::max(u, -4.0), 4.0);
    constexpr double kTolerance = 1e-10;  // rounding, over 400 ticks
    ASSERT_NEAR(answer.Values("position")[i], q, kTolerance) << "sample " << i;
    ASSERT_NEAR(answer.Values("speed")[i], v, kTolerance) << "sample " << i;
    ASSERT_NEAR(answer.Values("torque")[i], u, 100 * kTolerance) << "sample " << i;
    q += 0.01 * v + 0.5 * 1e-4 * u / kMass;
    v += 0.01 * u / kMass;
  }
  EXPECT_TRUE(paced);
  EXPECT_TRUE(limited);
}

// An open winding: neither torque nor braking by the back-EMF, whatever the voltage.
TEST(DriveOpenLoop, AMotorThatIsOffLeavesTheJointFree) {
  Bench bench;
  bench.input = "voltage";
  bench.input_unit = "V";
  bench.command = [](double) { return 12.0; };
  bench.constants = {{"resistance", 2}};
  bench.inputs["motor_on"] = {"1", [](double t) { return t < 0.995 ? 1.0 : 0.0; }};
  const auto problem = BindBench(bench);
  const auto answer = PredictDrive(*problem, DrivePoint(*problem, {{"inertia", 0.5},
                                                                   {"viscous_friction", 0.2},
                                                                   {"gravity_torque", 0},
                                                                   {"torque_constant", 0.3}}));
  const Vector speed = answer.Values("speed");
  EXPECT_GT(answer.Values("torque")[99], 0.1);
  for (int i = 100; i <= 400; ++i) {
    ASSERT_EQ(answer.Values("torque")[i], 0);
    ASSERT_EQ(answer.Values("current")[i], 0);
    ASSERT_NEAR(speed[i], speed[100] * std::exp(-0.2 / 0.5 * (i - 100) / 100.0), 1e-10);
  }
}

// A free joint under a torque that is a little wrong: the position leaves, and that is said.
TEST(DriveOpenLoop, ADriftIsSaid) {
  Bench bench;
  bench.command = [](double t) { return std::sin(3 * t); };
  Dataset data = BenchData(bench);
  Grid& grid = data.trials["swing"].grids["joint"];
  const auto measure = [&](double offset) {
    for (std::size_t i = 0; i < grid.time.size(); ++i) {
      const double t = grid.time[i];  // of an inertia of 0.5
      grid.channels["position"].values[i] = (t / 3 - std::sin(3 * t) / 9) / 0.5 + 0.5 * offset / 0.5 * t * t;
    }
    const auto problem = BindDriveData(data);
    EXPECT_TRUE(problem) << problem.error().message;
    const Vector at =
        DrivePoint(**problem, {{"inertia", 0.5}, {"viscous_friction", 0}, {"gravity_torque", 0}});
    std::vector<std::string> told;
    for (const Warning& warning : (*problem)->WarningsAt(at)) told.push_back(warning.message);
    return told;
  };
  EXPECT_TRUE(measure(0).empty());
  const auto told = measure(0.05);
  ASSERT_EQ(told.size(), 1U);
  EXPECT_NE(told[0].find("open loop on torque"), std::string::npos) << told[0];
  EXPECT_NE(told[0].find("(trial swing)"), std::string::npos) << told[0];
}

// Time stamps that jitter about the ticks must not decide by chance which sample a tick sees.
TEST(DriveClosedLoop, JitterOfTheTimeStampsChangesNothing) {
  Bench bench = SpeedControl();
  bench.settings += ", hold: zero";
  bench.command = [](double t) { return std::sin(2 * std::lround(100 * t) / 100.0); };
  const auto exact = BindBench(bench);
  for (int i = 0; i <= 400; ++i)
    bench.times.push_back(i / 100.0 + (i > 0 && i % 2 == 0 ? 2e-8 : -2e-8) * (i > 0));
  const auto jittered = BindBench(bench);
  const std::map<std::string, double> values{
      {"inertia", 0.2}, {"viscous_friction", 0.1}, {"gravity_torque", 0}};
  const auto a = PredictDrive(*exact, DrivePoint(*exact, values));
  const auto b = PredictDrive(*jittered, DrivePoint(*jittered, values));
  for (const char* channel : {"speed", "torque"})
    EXPECT_LT((a.Values(channel) - b.Values(channel)).cwiseAbs().maxCoeff(), 1e-6) << channel;
}

// Speeds of an inertia of 0.5 kg*m2 under the controller of SpeedControl, tick by tick. @param wanted at a
// tick
// @param fed_back of the speeds seen up to a tick, three at rest before the first
template <class Wanted, class FedBack>
std::vector<double> TickByTick(const Wanted& wanted, const FedBack& fed_back) {
  std::vector<double> speeds;
  std::vector<double> seen(3, 0.0);
  double v = 0;
  double integral = 0;
  double last = 0;
  for (int i = 0; i <= 100; ++i) {
    seen.push_back(v);
    const double error = wanted(i) - fed_back(seen);
    double u = 0.5 * error + 4 * (integral + 0.01 * error);
    if (i > 0) u += 0.002 * (error - last) / 0.01;
    if (std::abs(u) <= 0.6 || u * error <= 0) integral += 0.01 * error;
    u = std::min(std::max(u, -0.6), 0.6);
    last = error;
    speeds.push_back(v);
    v += 0.01 * u / 0.5;
  }
  return speeds;
}

std::vector<double> WithDelay(const Bench& bench, const std::string& delay, double seconds) {
  const auto problem = BindBench(bench);
  const Vector speeds =
      PredictDrive(
          *problem,
          DrivePoint(*problem,
                     {{"inertia", 0.5}, {"viscous_friction", 0}, {"gravity_torque", 0}, {delay, seconds}}))
          .Values("speed");
  return {speeds.data(), speeds.data() + 101};
}

TEST(DriveClosedLoop, ALateFeedbackIsOneThatWasSeenBefore) {
  Bench bench = SpeedControl();
  bench.command = [](double) { return 1.0; };
  // Two and a half ticks late; before the begin it was at rest.
  const auto expected = TickByTick(
      [](int) { return 1.0; },
      [](const std::vector<double>& seen) { return 0.5 * (seen[seen.size() - 3] + seen[seen.size() - 4]); });
  EXPECT_THAT(WithDelay(bench, "sensing_delay", 0.025), Pointwise(DoubleNear(1e-11), expected));
}

TEST(DriveClosedLoop, ALateOutputIsOneThatWasCommandedBefore) {
  Bench bench = SpeedControl();
  bench.command = [](double t) { return std::sin(3 * t); };
  // Three ticks late; before the begin it was at rest, and what was commanded then is that of the first tick.
  const auto expected = TickByTick([](int i) { return i < 3 ? 0 : std::sin(3 * (i - 3) * 0.01); },
                                   [](const std::vector<double>& seen) { return seen[seen.size() - 4]; });
  EXPECT_THAT(WithDelay(bench, "actuation_delay", 0.03), Pointwise(DoubleNear(1e-11), expected));
}

TEST(DriveClosedLoop, ConditionsOfATrialWinOverTheSettings) {
  Bench bench;
  bench.input = "reference";
  bench.input_unit = "rad";
  bench.command = [](double t) { return std::sin(t); };
  bench.settings = "controller: {kind: servo, kp: 400}";
  bench.constants = {{"load_mass", 0.5}, {"load_length", 0.1}, {"supply_voltage", 7.4}};
  Dataset data = BenchData(bench);
  data.trials["swing"].conditions["kp"] = 100;
  const auto problem = BindDriveData(data);
  ASSERT_TRUE(problem) << problem.error().message;
  EXPECT_EQ((*problem)->data().runs[0].gains.kp, 100);
}

}  // namespace
}  // namespace sinew
