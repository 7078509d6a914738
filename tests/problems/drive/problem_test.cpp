// The motion of the joint against what can be written down.
#include "problems/drive/problem.h"

#include <algorithm>

#include "tests/problems/support/drive_bench.h"

namespace sinew {
namespace {

constexpr double kRounding = 1e-12;  // of steps that are exact: cubics in time

double MultiSine(double t) {
  return 0.5 * std::sin(3 * t) + 0.3 * std::sin(7.3 * t + 1) - 0.2 * std::cos(11 * t);
}

TEST(DriveProblem, PeriodOfThePendulumIsTheEllipticIntegral) {
  constexpr double kInertiaValue = 0.05;
  constexpr double kGravity = 0.6;
  constexpr double kAngle = 1.2;
  // 4 K(k) / omega = 2 pi / (omega agm(1, cos(angle / 2)))
  double a = 1;
  double b = std::cos(kAngle / 2);
  for (int i = 0; i < 10; ++i) {
    const double mean = (a + b) / 2;
    b = std::sqrt(a * b);
    a = mean;
  }
  const double period = 2 * M_PI / (std::sqrt(kGravity / kInertiaValue) * a);
  Bench bench;
  for (int i = 0; i <= 200; ++i) bench.times.push_back(period * i / 200);
  bench.step = 0.002;
  const auto problem = BindBench(bench);
  const auto answer = PredictDrive(*problem, DrivePoint(*problem, {{"inertia", kInertiaValue},
                                                                   {"viscous_friction", 0},
                                                                   {"gravity_torque", kGravity},
                                                                   {"initial_position@swing", kAngle}}));
  // Global error of order (omega h)^4 / 120 times the phase: 2e-10 for 2 ms.
  EXPECT_NEAR(answer.Values("position")[200], kAngle, 1e-9);
  EXPECT_NEAR(answer.Values("position")[100], -kAngle, 1e-9);
  EXPECT_NEAR(answer.Values("position")[50], 0, 1e-9);
}

TEST(DriveProblem, ErrorFallsWithTheFourthPowerOfTheStep) {
  Bench bench;
  bench.command = MultiSine;
  const auto at = [&](double step) {
    bench.step = step;
    const auto problem = BindBench(bench);
    return PredictDrive(*problem, DrivePoint(*problem, {{"inertia", 0.05},
                                                        {"viscous_friction", 0.1},
                                                        {"gravity_torque", 0.6},
                                                        {"initial_position@swing", 0.4}}))
        .Values("position");
  };
  const Vector exact = at(0.01 / 32);
  const double coarse = (at(0.01) - exact).norm();
  const double fine = (at(0.005) - exact).norm();
  EXPECT_NEAR(std::log2(coarse / fine), 4, 0.15);  // the next order is a few per cent at these steps
}

TEST(DriveProblem, ABudgetOfStepsIsKept) {
  Bench bench;
  bench.command = MultiSine;
  bench.step = 0.001;  // ten between two samples
  for (const int steps : {5, 50}) {
    bench.settings = "most_steps: " + std::to_string(steps);
    const auto problem = BindBench(bench);
    Prediction prediction(problem->layout());
    const std::vector<bool> all(problem->layout().size(), true);
    const auto workspace = problem->NewWorkspace();
    const Status status =
        problem->Predict({DrivePoint(*problem, {}), all, false, nullptr}, *workspace, prediction);
    EXPECT_EQ(status ? "" : status.error().message,
              steps == 50 ? "" : "trial 'swing': too stiff to integrate at t = 0 s");
  }
}

TEST(DriveProblem, SlidesToRestInExactTime) {
  constexpr double kMass = 0.2;
  constexpr double kFriction = 0.37;
  constexpr double kSpeed = 1.3;
  const auto problem = BindBench({});
  const auto answer = PredictDrive(*problem, DrivePoint(*problem, {{"inertia", kMass},
                                                                   {"viscous_friction", 0},
                                                                   {"gravity_torque", 0},
                                                                   {"coulomb_torque", kFriction},
                                                                   {"initial_speed@swing", kSpeed}}));
  const Vector position = answer.Values("position");
  const Vector speed = answer.Values("speed");
  const double stop = kSpeed * kMass / kFriction;  // 0.703 s
  for (int i = 0; i < position.size(); ++i) {
    const double t = std::min(0.01 * i, stop);
    EXPECT_NEAR(position[i], kSpeed * t - 0.5 * kFriction / kMass * t * t, kRounding);
    EXPECT_NEAR(speed[i], kSpeed - kFriction / kMass * t, kRounding);
  }
  EXPECT_EQ(speed[100], 0);
  // Where it stops: v^2 M / (2 F).
  const double way = kSpeed * kSpeed * kMass / (2 * kFriction);
  EXPECT_NEAR(answer.Derivative("position", "coulomb_torque")[100], -way / kFriction, kRounding);
  EXPECT_NEAR(answer.Derivative("position", "inertia")[100], way / kMass, kRounding);
  EXPECT_NEAR(answer.Derivative("position", "initial_speed@swing")[100], 2 * way / kSpeed, kRounding);
  EXPECT_EQ(answer.Derivative("speed", "coulomb_torque")[100], 0);
}

TEST(DriveProblem, BreaksAwayAtTheExactInstant) {
  constexpr double kMass = 0.2;
  constexpr double kFriction = 0.3337;
  constexpr double kRamp = 0.25;  // [N*m/s]
  Bench bench;
  bench.command = [](double t) { return -kRamp * t; };
  const auto problem = BindBench(bench);
  const auto answer = PredictDrive(*problem, DrivePoint(*problem, {{"inertia", kMass},
                                                                   {"viscous_friction", 0},
                                                                   {"gravity_torque", 0},
                                                                   {"backward_friction", kFriction}}));
  const double away = kFriction / kRamp;  // 1.3348 s
  for (int i = 0; i <= 400; ++i) {
    const double since = std::max(0.01 * i - away, 0.0);
    EXPECT_NEAR(answer.Values("position")[i], -kRamp * since * since * since / (6 * kMass), kRounding);
    EXPECT_NEAR(answer.Derivative("position", "backward_friction")[i], since * since / (2 * kMass), 1e-10);
    EXPECT_EQ(answer.Derivative("position", "forward_friction")[i], 0);
  }
}

TEST(DriveProblem, SticksWhileFrictionHoldsItAndReversesWhereItDoesNot) {
  Bench bench;
  bench.command = [](double t) { return 0.5 * std::sin(2 * t); };
  const auto problem = BindBench(bench);
  const auto at = [&](double friction) {
    return PredictDrive(*problem, DrivePoint(*problem, {{"inertia", 0.02},
                                                        {"viscous_friction", 0.02},
                                                        {"gravity_torque", 0.1},
                                                        {"coulomb_torque", friction}}))
        .Values("speed");
  };
  const auto rests = [](const Vector& speed) { return (speed.array() == 0).count(); };
  EXPECT_LE(rests(at(0)), 1);
  EXPECT_GT(rests(at(0.3)), 50);
  EXPECT_LT(rests(at(0.3)), 300);
  EXPECT_EQ(rests(at(0.51)), 401);
}

TEST(DriveProblem, ValuesDoNotDependOnWhatIsDifferentiated) {
  Bench bench;
  bench.command = MultiSine;
  const auto problem = BindBench(bench);
  const auto count = problem->parameters().size();
  for (const double friction : {0.0, 0.1}) {
    const Vector point = DrivePoint(*problem, {{"coulomb_torque", friction}, {"gravity_torque", 0.3}});
    const Vector expected = PredictDrive(*problem, point).Values("position");
    for (std::size_t only = 0; only < count; ++only) {
      std::vector<bool> differentiate(count, false);
      differentiate[only] = true;
      EXPECT_EQ(PredictDrive(*problem, point, &differentiate).Values("position"), expected)
          << problem->parameters()[only].name;
    }
  }
}

TEST(DriveProblem, LinearAxisUnderForceOnAnIncline) {
  Bench bench;
  bench.input = "force";
  bench.input_unit = "N";
  bench.rotary = false;
  bench.command = [](double t) { return 3 + t; };
  bench.constants = {{"incline_force", 2}};
  const auto problem = BindBench(bench);
  EXPECT_EQ(problem->parameters()[0].unit, "kg");
  EXPECT_FALSE(FindParameter(problem->parameters(), "gravity_torque"));
  const Vector position =
      PredictDrive(*problem, DrivePoint(*problem, {{"inertia", 4}, {"viscous_friction", 0}}))
          .Values("position");
  for (int i = 0; i <= 400; ++i) {
    const double t = 0.01 * i;
    EXPECT_NEAR(position[i], (t * t / 2 + t * t * t / 6) / 4, kRounding);
  }
}

TEST(DriveProblem, VoltageDriveReachesItsNoLoadSpeed) {
  Bench bench;
  bench.input = "voltage";
  bench.input_unit = "V";
  bench.command = [](double) { return 12.0; };
  bench.constants = {{"resistance", 2}, {"gear_ratio", 5}};
  const auto problem = BindBench(bench);
  const auto answer = PredictDrive(*problem, DrivePoint(*problem, {{"inertia", 0.5},
                                                                   {"viscous_friction", 0},
                                                                   {"gravity_torque", 0},
                                                                   {"torque_constant", 0.3}}));
  // M dv/dt = N kt / R (u - N kt v)
  const double top = 12 / (5 * 0.3);
  const double rate = 1.5 * 1.5 / (2 * 0.5);
  for (int i = 0; i <= 400; ++i) {
    const double left = std::exp(-rate * 0.01 * i);
    EXPECT_NEAR(answer.Values("speed")[i], top * (1 - left), 1e-8);  // (rate h)^4 / 120
    EXPECT_NEAR(answer.Values("current")[i], 12 * left / 2, 1e-8);
    EXPECT_NEAR(answer.Values("torque")[i], 1.5 * 12 * left / 2, 1e-8);
  }
}

TEST(DriveProblem, AWindingThatWarmsUpDelaysTheNoLoadSpeed) {
  Bench bench;
  bench.input = "voltage";
  bench.input_unit = "V";
  bench.command = [](double) { return 12.0; };
  bench.constants = {{"resistance", 2}, {"gear_ratio", 5}};
  const auto problem = BindBench(bench);
  constexpr double kGrowth = 0.1;  // [1/s] of the resistance
  const auto answer = PredictDrive(*problem, DrivePoint(*problem, {{"inertia", 0.5},
                                                                   {"viscous_friction", 0},
                                                                   {"gravity_torque", 0},
                                                                   {"torque_constant", 0.3},
                                                                   {"resistance_rate", kGrowth}}));
  // M dv/dt = N kt / (R (1 + growth t)) (u - N kt v)
  const double rate = 1.5 * 1.5 / (2 * 0.5);
  for (int i = 0; i <= 400; ++i) {
    const double warm = 1 + kGrowth * 0.01 * i;
    const double left = std::pow(warm, -rate / kGrowth);
    EXPECT_NEAR(answer.Values("speed")[i], 12 / 1.5 * (1 - left), 1e-8);  // (rate h)^4 / 120
    EXPECT_NEAR(answer.Values("current")[i], 12 * left / (2 * warm), 1e-8);
  }
}

// Laws that must agree although they are written elsewhere.
TEST(DriveProblem, EffectsThatMeanTheSameAgree) {
  Bench bench;
  bench.command = MultiSine;
  const auto problem = BindBench(bench);
  const std::map<std::string, double> joint{
      {"inertia", 0.05}, {"viscous_friction", 0.1}, {"gravity_torque", 0.6}};
  const auto with = [&](const Problem& of, std::map<std::string, double> values) {
    values.insert(joint.begin(), joint.end());
    return PredictDrive(of, DrivePoint(of, values));
  };
  const auto expect_same = [](const Vector& a, const Vector& b) { EXPECT_LT((a - b).norm(), 1e-11); };
  expect_same(with(*problem, {{"offset_torque", 0.1}}).Values("position"),
              with(*problem, {{"torque.offset", -0.1}}).Values("position"));
  expect_same(with(*problem, {{"command_delay", 0.0137}}).Values("position"),
              with(*problem, {{"torque.time_offset", -0.0137}}).Values("position"));
  expect_same(with(*problem, {{"coulomb_torque", 0.1}}).Values("position"),
              with(*problem, {{"forward_friction", 0.1}, {"backward_friction", 0.1}}).Values("position"));
  Bench held = bench;
  held.settings = "hold: zero";
  const auto held_problem = BindBench(held);
  expect_same(with(*problem, {{"hold_fraction", 1}}).Values("position"),
              with(*held_problem, {}).Values("position"));
}

// An unknown term that is constant is the effect of that name; one that is not is read at its signal.
TEST(DriveProblem, UnknownTermsActWhereTheyAreNamed) {
  Bench bench;
  bench.command = MultiSine;
  const auto problem = BindBench(bench);
  const auto position = [&](std::map<std::string, double> values) {
    values.insert({{"inertia", 0.05}, {"gravity_torque", 0.6}});
    values.insert({"viscous_friction", 0.1});
    return PredictDrive(*problem, DrivePoint(*problem, values)).Values("position");
  };
  const auto constant = [](const std::string& term, int knots, double value) {
    std::map<std::string, double> values;
    for (int k = 0; k < knots; ++k) values[term + "[" + std::to_string(k) + "]"] = value;
    return values;
  };
  const auto expect_same = [](const Vector& a, const Vector& b) { EXPECT_LT((a - b).norm(), 1e-11); };
  expect_same(position(constant("torque(velocity)", 8, 0.1)), position({{"offset_torque", 0.1}}));
  expect_same(position(constant("friction(position)", 16, 0.04)), position({{"coulomb_torque", 0.04}}));
  expect_same(position(constant("friction(time)", 8, 0.04)), position({{"coulomb_torque", 0.04}}));
  expect_same(position(constant("damping(time)", 8, -0.06)), position({{"viscous_friction", 0.04}}));
  // The last of eight knots over the trial's 2 s reaches back to its neighbour, at 12/7 s.
  const Vector before = position({{"damping(time)[7]", 0.1}}) - position({});
  EXPECT_EQ(before.head(341).norm(), 0);
  EXPECT_GT(before.tail(20).norm(), 1e-4);
}

TEST(DriveProblem, ADelayShiftsTheAnswerToASharpCommand) {
  Bench bench;
  bench.command = [](double t) { return t < 1 ? 0.0 : 0.2; };
  const auto problem = BindBench(bench);
  const std::map<std::string, double> joint{
      {"inertia", 0.05}, {"viscous_friction", 0}, {"gravity_torque", 0}};
  auto late = joint;
  late["command_delay"] = 0.05;
  const Vector now = PredictDrive(*problem, DrivePoint(*problem, joint)).Values("position");
  const Vector then = PredictDrive(*problem, DrivePoint(*problem, late)).Values("position");
  for (int i = 5; i <= 400; ++i) EXPECT_NEAR(then[i], now[i - 5], kRounding);
}

TEST(DriveProblem, PlayAndWindUpAreSeenNotFelt) {
  Bench bench;
  bench.command = MultiSine;
  const auto problem = BindBench(bench);
  std::map<std::string, double> values{{"inertia", 0.05}, {"viscous_friction", 0.1}, {"gravity_torque", 0.6}};
  const auto plain = PredictDrive(*problem, DrivePoint(*problem, values));
  values["backlash_width"] = 0.05;
  const auto play = PredictDrive(*problem, DrivePoint(*problem, values));
  const Vector gap = play.Values("position") - plain.Values("position");
  EXPECT_NEAR(gap.maxCoeff(), 0.025, kRounding);
  EXPECT_NEAR(gap.minCoeff(), -0.025, kRounding);
  EXPECT_EQ(play.Values("speed"), plain.Values("speed"));
  values["backlash_width"] = 0;
  values["transmission_compliance"] = 0.1;
  const auto soft = PredictDrive(*problem, DrivePoint(*problem, values));
  const Vector wound = plain.Values("position") + 0.1 * plain.Values("torque");
  EXPECT_LT((soft.Values("position") - wound).norm(), kRounding);
}

// Where in its play a joint begins is not known, but its first reading is.
TEST(DriveProblem, PlayBeginsWhereTheFirstReadingWasMeasured) {
  Bench bench;
  bench.command = MultiSine;
  const auto problem = BindBench(bench);
  std::map<std::string, double> values{{"inertia", 0.05}, {"viscous_friction", 0.1}, {"gravity_torque", 0.6}};
  const Vector joint = PredictDrive(*problem, DrivePoint(*problem, values)).Values("position");
  const double measured = problem->layout().front().measured.front();
  ASSERT_EQ(measured, 0.8);
  for (const auto& [width, first] :
       {std::pair{0.05, 0.025}, std::pair{1.0, 0.5}, std::pair{1.8, measured}, std::pair{0.0, 0.0}}) {
    values["backlash_width"] = width;
    const Vector seen = PredictDrive(*problem, DrivePoint(*problem, values)).Values("position");
    EXPECT_NEAR(seen[0], first, kRounding) << width;
    EXPECT_LT((seen - joint).cwiseAbs().maxCoeff(), 0.5 * width + kRounding);
  }
}

TEST(DriveProblem, ARunawayIsAFailureWithItsTime) {
  Bench bench;
  bench.command = [](double) { return 1.0; };
  const auto problem = BindBench(bench);
  Prediction prediction(problem->layout());
  const auto workspace = problem->NewWorkspace();
  const std::vector<bool> all(problem->layout().size(), true);
  const Vector point =
      DrivePoint(*problem, {{"inertia", 1e-8}, {"viscous_friction", 0}, {"gravity_torque", 0}});
  const Status status = problem->Predict({point, all, false, nullptr}, *workspace, prediction);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().message.rfind("trial 'swing': the motion runs away at t = ", 0), 0U)
      << status.error().message;
}

}  // namespace
}  // namespace sinew
