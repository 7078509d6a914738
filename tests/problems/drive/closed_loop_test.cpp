// Joints under a controller that is known.
#include "tests/problems/support/drive_bench.h"

namespace sinew {
namespace {

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

TEST(DriveClosedLoop, ALateFeedbackIsOneThatWasSeenBefore) {
  Bench bench = SpeedControl();
  bench.command = [](double) { return 1.0; };
  const auto problem = BindBench(bench);
  const auto answer = PredictDrive(*problem, DrivePoint(*problem, {{"inertia", 0.5},
                                                                   {"viscous_friction", 0},
                                                                   {"gravity_torque", 0},
                                                                   {"sensing_delay", 0.025}}));
  // Two and a half ticks late; before the begin it was at rest.
  double v = 0;
  double integral = 0;
  double last = 0;
  std::vector<double> seen(3, 0.0);
  for (int i = 0; i <= 100; ++i) {
    seen.push_back(v);
    const double error = 1 - 0.5 * (seen[seen.size() - 3] + seen[seen.size() - 4]);
    double u = 0.5 * error + 4 * (integral + 0.01 * error);
    if (i > 0) u += 0.002 * (error - last) / 0.01;
    if (std::abs(u) <= 0.6 || u * error <= 0) integral += 0.01 * error;
    u = std::min(std::max(u, -0.6), 0.6);
    last = error;
    ASSERT_NEAR(answer.Values("speed")[i], v, 1e-11) << "sample " << i;
    v += 0.01 * u / 0.5;
  }
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
