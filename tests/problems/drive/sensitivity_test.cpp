// Every derivative against differences, through reversals, sticking and breaking away, in every kind of
// drive.
#include "tests/problems/support/drive_bench.h"
#include "tests/problems/support/jacobian_check.h"

namespace sinew {
namespace {

constexpr double kTolerance = 1e-6;  // of differences, see CheckJacobian
// CheckJacobian leaves columns out that are far from straight within its step. Those must agree too, as well
// as differences can tell: curvature over 1e-7 of a range, and samples next to which something happens.
constexpr double kStep = 1e-7;
constexpr double kLoose = 1e-4;
constexpr double kFewSamples = 0.03;

double Slow(double t) {
  return 0.5 * std::sin(2.1 * t) + 0.3 * std::sin(5.3 * t + 1);
}

void ExpectExactDerivatives(const Bench& bench, const std::map<std::string, double>& values) {
  const auto problem = BindBench(bench);
  ASSERT_NE(problem, nullptr);
  Vector point = DrivePoint(*problem, values);
  for (std::size_t i = 0; i < problem->parameters().size(); ++i) {  // differences go both ways
    const Parameter& p = problem->parameters()[i];
    const double inside = 0.01 * (p.upper - p.lower);
    double& value = point[static_cast<Eigen::Index>(i)];
    if (p.kind == ParameterKind::kEffect) value = std::clamp(value, p.lower + inside, p.upper - inside);
  }
  const JacobianCheck check = CheckJacobian(*problem, point);
  EXPECT_LT(check.worst, kTolerance);
  EXPECT_GT(check.compared, check.columns / 2);
  const DriveAnswer at = PredictDrive(*problem, point);
  for (std::size_t i = 0; i < problem->parameters().size(); ++i) {
    const Parameter& p = problem->parameters()[i];
    const double width = p.scale == Scale::kLog ? point[static_cast<Eigen::Index>(i)] : p.upper - p.lower;
    const auto moved = [&](double steps) {
      Vector q = point;
      q[static_cast<Eigen::Index>(i)] += steps * kStep * width;
      return PredictDrive(*problem, q);
    };
    const DriveAnswer up = moved(1);
    const DriveAnswer down = moved(-1);
    for (const std::string channel : {"position", "speed"}) {
      const Vector difference = (up.Values(channel) - down.Values(channel)) / (2 * kStep);
      const Vector derivative = width * at.Derivative(channel, p.name);
      const double size =
          std::max(derivative.cwiseAbs().maxCoeff(), 1e-3 * at.Values(channel).cwiseAbs().maxCoeff());
      const auto wrong = ((difference - derivative).array().abs() > kLoose * size).count();
      EXPECT_LE(static_cast<double>(wrong), kFewSamples * static_cast<double>(derivative.size()))
          << channel << " for " << p.name;
    }
  }
}

long Rests(const Bench& bench, const std::map<std::string, double>& values) {
  const auto problem = BindBench(bench);
  return (PredictDrive(*problem, DrivePoint(*problem, values)).Values("speed").array() == 0).count();
}

// Inside all bounds, so that differences can go both ways.
std::map<std::string, double> EveryEffect() {
  return {{"inertia", 0.03},
          {"viscous_friction", 0.05},
          {"gravity_torque", 0.3},
          {"coulomb_torque", 0.06},
          {"forward_friction", 0.01},
          {"backward_friction", 0.02},
          {"stribeck_torque", 0.05},
          {"stribeck_velocity", 0.4},
          {"load_friction_coefficient", 0.05},
          {"motor_load_friction", 0.04},
          {"external_load_friction", 0.03},
          {"stribeck_load_coefficient", 0.05},
          {"stribeck_load_velocity", 0.3},
          {"quadratic_load_coefficient", 0.1},
          {"viscous_asymmetry", 0.01},
          {"drag_coefficient", 0.01},
          {"cogging_cos", 0.02},
          {"cogging_sin", 0.03},
          {"imbalance_torque", 0.05},
          {"spring_stiffness", 0.1},
          {"cubic_stiffness", 0.07},
          {"offset_torque", 0.02},
          {"compression", 0.1},
          {"thermal_rate", 0.01},
          {"warm_up_gain", -0.1},
          {"warm_up_time", 0.8},
          {"command_delay", 0.0133},
          {"hold_fraction", 0.3},
          {"transmission_compliance", 0.02},
          {"torque.offset", 0.01},
          {"torque.gain", 1.1},
          {"torque.drift", 0.01},
          {"torque.time_offset", 0.004},
          {"torque.low_pass", 0.02},
          {"torque(position)[3]", 0.05},
          {"torque(velocity)[4]", 0.04},
          {"torque(command)[2]", 0.03},
          {"torque(time)[5]", 0.02},
          {"friction(position)[7]", 0.03},
          {"friction(time)[3]", 0.02},
          {"damping(time)[4]", 0.02},
          {"initial_position@swing", 0.2},
          {"initial_speed@swing", 0.5}};
}

TEST(DriveSensitivity, OfEveryEffectAtOnce) {
  Bench bench;
  bench.command = Slow;
  EXPECT_GT(Rests(bench, EveryEffect()), 3) << "it should stick somewhere";
  ExpectExactDerivatives(bench, EveryEffect());
}

TEST(DriveSensitivity, ThroughStickAndSlip) {
  Bench bench;
  bench.command = Slow;
  const std::map<std::string, double> values{{"inertia", 0.03},
                                             {"viscous_friction", 0.05},
                                             {"gravity_torque", 0.3},
                                             {"coulomb_torque", 0.2},
                                             {"stribeck_torque", 0.1},
                                             {"stribeck_velocity", 0.3},
                                             {"initial_position@swing", 0.2},
                                             {"initial_speed@swing", 0.1}};
  const long rests = Rests(bench, values);
  EXPECT_GT(rests, 20);
  EXPECT_LT(rests, 350);
  ExpectExactDerivatives(bench, values);
}

TEST(DriveSensitivity, ThroughReversalsWithoutSticking) {
  Bench bench;
  bench.command = Slow;
  ExpectExactDerivatives(bench, {{"inertia", 0.03},
                                 {"viscous_friction", 0.02},
                                 {"gravity_torque", 0.9},
                                 {"coulomb_torque", 0.03},
                                 {"initial_position@swing", 0.8},
                                 {"initial_speed@swing", 0.1}});
}

TEST(DriveSensitivity, OfDelaysOfAHeldInput) {
  Bench bench;
  bench.command = Slow;
  bench.settings = "hold: zero";
  ExpectExactDerivatives(bench, {{"inertia", 0.03},
                                 {"coulomb_torque", 0.05},
                                 {"gravity_torque", 0.3},
                                 {"command_delay", 0.0171},
                                 {"initial_position@swing", 0.2},
                                 {"initial_speed@swing", 0.5}});
}

TEST(DriveSensitivity, OfAHeldInputAtDelayZeroIsThatOfLaterCommands) {
  Bench bench;
  bench.command = Slow;
  bench.settings = "hold: zero";
  const auto problem = BindBench(bench);
  std::map<std::string, double> values{
      {"inertia", 0.03}, {"viscous_friction", 0.05}, {"gravity_torque", 0.3}};
  const auto here = PredictDrive(*problem, DrivePoint(*problem, values));
  constexpr double kDelay = 1e-6;
  values["command_delay"] = kDelay;
  const auto there = PredictDrive(*problem, DrivePoint(*problem, values));
  const Vector difference = (there.Values("position") - here.Values("position")) / kDelay;
  const Vector derivative = here.Derivative("position", "command_delay");
  EXPECT_GT(derivative.norm(), 1);
  EXPECT_LT((difference - derivative).norm(),
            1e-4 * derivative.norm());  // one-sided: first order in the step
}

TEST(DriveSensitivity, OfAServoWithASensingDelay) {
  Bench bench;
  bench.input = "reference";
  bench.input_unit = "rad";
  bench.command = Slow;
  bench.settings = "controller: {kind: servo, kp: 100}";
  bench.constants = {{"load_mass", 0.5}, {"load_length", 0.1}, {"supply_voltage", 7.4}};
  ExpectExactDerivatives(bench, {{"inertia", 0.002},
                                 {"viscous_friction", 0.01},
                                 {"torque_constant", 0.3},
                                 {"resistance", 4.5},
                                 {"resistance_rate", 0.05},
                                 {"coulomb_torque", 0.01},
                                 {"sensing_delay", 0.005},
                                 {"actuation_delay", 0.004},
                                 {"command_delay", 0.013},
                                 {"initial_position@swing", 0.2},
                                 {"initial_speed@swing", 0.1}});
}

TEST(DriveSensitivity, OfASampledControllerWithLimitAndDelay) {
  Bench bench;
  bench.input = "reference";
  bench.input_unit = "rad/s";
  bench.command = [](double t) { return 3 * Slow(t); };
  bench.settings =
      "controller: {kind: pid_speed, kp: 0.3, ki: 1.5, kd: 0.001, control_period: 0.004, output_limit: 0.4}";
  ExpectExactDerivatives(bench, {{"inertia", 0.03},
                                 {"viscous_friction", 0.05},
                                 {"gravity_torque", 0.3},
                                 {"coulomb_torque", 0.05},
                                 {"sensing_delay", 0.0066},
                                 {"actuation_delay", 0.0043},
                                 {"command_delay", 0.013},
                                 {"compression", 0.1},
                                 {"initial_position@swing", 0.2},
                                 {"initial_speed@swing", 0.5}});
}

TEST(DriveSensitivity, OfACascadeWhoseMotorIsSwitched) {
  Bench bench;
  bench.input = "reference";
  bench.input_unit = "rad";
  bench.command = [](double t) { return Slow(t) - Slow(0); };
  bench.settings =
      "controller: {kind: cascade, position_gain: 12, velocity_gain: 1.2, velocity_integral: 8, "
      "velocity_filter: 0.003, velocity_feedforward: 0.9, acceleration_feedforward: 0.02, control_period: "
      "0.004, speed_limit: 2, output_limit: 0.6, initial_integral: fitted}";
  bench.inputs["disturbance"] = {"N*m", [](double t) { return 0.1 * std::sin(9 * t); }};
  bench.inputs["motor_on"] = {"1", [](double t) { return t < 2.5 || t >= 3 ? 1.0 : 0.0; }};
  ExpectExactDerivatives(bench, {{"inertia", 0.03},
                                 {"viscous_friction", 0.05},
                                 {"gravity_torque", 0.3},
                                 {"coulomb_torque", 0.05},
                                 {"sensing_delay", 0.0066},
                                 {"actuation_delay", 0.0012},
                                 {"command_delay", 0.013},
                                 {"compression", 0.1},
                                 {"reference.gain", 1.1},
                                 {"initial_position@swing", 0.2},
                                 {"initial_speed@swing", 0.5},
                                 {"initial_integral@swing", 0.1}});
}

TEST(DriveSensitivity, OfACascadeThatBeginsHeldByFriction) {
  Bench bench;
  bench.input = "reference";
  bench.input_unit = "rad";
  bench.command = [](double t) { return 0.1 + Slow(t) - Slow(0); };
  bench.settings =
      "controller: {kind: cascade, position_gain: 12, velocity_gain: 1.2, velocity_integral: 8, "
      "velocity_filter: 0.003, control_period: 0.004, output_limit: 0.6}";
  const auto problem = BindBench(bench);
  const auto at = [&](double speed) {
    return PredictDrive(*problem, DrivePoint(*problem, {{"inertia", 0.03},
                                                        {"viscous_friction", 0.05},
                                                        {"gravity_torque", 0.3},
                                                        {"coulomb_torque", 0.2},
                                                        {"transmission_compliance", 0.02},
                                                        {"initial_position@swing", 0.1},
                                                        {"initial_speed@swing", speed}}));
  };
  // Friction takes the speed away at once, but the controller has seen it.
  constexpr double kSpeed = 1e-6;
  const Vector difference = (at(kSpeed).Values("position") - at(-kSpeed).Values("position")) / (2 * kSpeed);
  const Vector derivative = at(0).Derivative("position", "initial_speed@swing");
  const double size = derivative.cwiseAbs().maxCoeff();
  EXPECT_GT(size, 1e-3);
  EXPECT_LT((difference - derivative).cwiseAbs().maxCoeff(), 1e-3 * size);
}

TEST(DriveSensitivity, OfAServoWhoseMotorIsOff) {
  Bench bench;
  bench.input = "reference";
  bench.input_unit = "rad";
  bench.command = Slow;
  bench.settings = "controller: {kind: servo, kp: 100}";
  bench.constants = {{"load_mass", 0.5}, {"load_length", 0.1}, {"supply_voltage", 7.4}};
  bench.inputs["motor_on"] = {"1", [](double t) { return t < 2 ? 1.0 : 0.0; }};
  ExpectExactDerivatives(bench, {{"inertia", 0.002},
                                 {"viscous_friction", 0.01},
                                 {"torque_constant", 0.1},
                                 {"resistance", 4.5},
                                 {"coulomb_torque", 0.01},
                                 {"motor_load_friction", 0.1},
                                 {"initial_position@swing", 0.2},
                                 {"initial_speed@swing", 0.1}});
}

TEST(DriveSensitivity, OfADeadZone) {
  Bench bench;
  bench.command = Slow;
  ExpectExactDerivatives(bench, {{"inertia", 0.03},
                                 {"viscous_friction", 0.05},
                                 {"gravity_torque", 0.3},
                                 {"dead_zone_width", 0.1},
                                 {"compression", 0.1},
                                 {"initial_position@swing", 0.2},
                                 {"initial_speed@swing", 0.5}});
}

TEST(DriveSensitivity, OfBacklashAndLimits) {
  Bench bench;
  bench.command = Slow;
  ExpectExactDerivatives(bench, {{"inertia", 0.03},
                                 {"viscous_friction", 0.05},
                                 {"gravity_torque", 0.3},
                                 {"coulomb_torque", 0.05},
                                 {"backlash_width", 0.1},
                                 {"inverse_torque_limit", 1.7},
                                 {"inverse_speed_limit", 0.45},
                                 {"initial_position@swing", 0.2},
                                 {"initial_speed@swing", 0.5}});
}

}  // namespace
}  // namespace sinew
