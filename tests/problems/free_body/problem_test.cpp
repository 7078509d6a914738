#include "problems/free_body/problem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/constants.h"
#include "base/random.h"
#include "identify/fit_setup.h"
#include "identify/solvers/local_fit.h"
#include "problems/free_body/settings.h"
#include "problems/free_body/synthesis.h"

namespace sinew {
namespace {

FreeBody Cube(FreeBodyContact contact = FreeBodyContact::kVertices) {
  FreeBody body;
  body.contact = contact;
  const Vec3 edges = Vec3::Constant(0.1);
  body.points = PointsOfBox(edges, contact, 8);
  body.mass = 0.4;
  body.inertia = Vec3(7e-4, 8e-4, 9e-4);
  body.size = 0.05;
  body.reach = edges.norm() / 2;
  body.accuracy = 1e-9;
  for (auto& knots : body.knots) knots = {-1, 0, 0.2, 0.5, 1, 1.5, 2};
  return body;
}

FreeBodyNumbers Ordinary(FreeBodyContact contact = FreeBodyContact::kVertices) {
  FreeBodyNumbers numbers;
  numbers.value[kStiffness] = contact == FreeBodyContact::kVertices ? 3e5 : 2e9;
  numbers.value[kDissipation] = 1;
  numbers.value[kFriction] = 0.3;
  return numbers;
}

std::vector<double> Evenly(double duration, int frames) {
  std::vector<double> times;
  for (int i = 0; i < frames; ++i) times.push_back(duration * i / (frames - 1));
  return times;
}

std::vector<Pose> FlyPlainly(const FreeBody& body, const FreeBodyNumbers& numbers, const FlightStart& start,
                             const std::vector<double>& times) {
  FlightLimits limits;
  limits.accuracy = body.accuracy;
  limits.most_steps = 1000000;
  std::vector<Pose> poses(times.size());
  const Status status = Fly(body, numbers.value, numbers.Used(), start, -1, times, limits, poses.data());
  EXPECT_TRUE(status) << status.error().message;
  return poses;
}

// Turned so that a corner points down, with spin.
FlightStart Thrown(double height) {
  FlightStart start;
  start.pose = {0.01, -0.02, height, 0.8, 0.4, 0.3, std::sqrt(1 - 0.64 - 0.16 - 0.09)};
  start.velocity << 0.7, 0.4, -0.1;
  start.spin << 3, -5, 2;
  return start;
}

TEST(FreeBodyFlightTest, FliesLikeAThrownStoneUntilItTouches) {
  const FreeBody body = Cube();
  const FlightStart start = Thrown(5);
  const auto times = Evenly(0.4, 9);
  const auto poses = FlyPlainly(body, Ordinary(), start, times);
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double t = times[i];
    EXPECT_NEAR(poses[i][0], start.pose[0] + 0.7 * t, 1e-9);
    EXPECT_NEAR(poses[i][2], start.pose[2] - 0.1 * t - 0.5 * body.gravity * t * t, 1e-9);
  }
}

// Euler's equations: the angular momentum in the world stays, though the body's axes tumble.
TEST(FreeBodyFlightTest, AStateIsMovedToAnotherOneByTheirDifference) {
  FlightStart from;
  from.pose = {0.1, -0.2, 0.3, 0.5, 0.5, -0.5, 0.5};
  from.velocity = Vec3(1, 2, -3);
  from.spin = Vec3(-4, 5, 6);
  Vector by(kStartLanes);
  by << 0.01, -0.02, 0.03, 0.5, -0.4, 0.3, 0.1, 0.2, -0.3, 1, -2, 3;
  const FlightStart to = from.Moved(by);
  EXPECT_LT((from.MoveTo(to) - by).cwiseAbs().maxCoeff(), 1e-14);
}

TEST(FreeBodyFlightTest, KeepsItsAngularMomentum) {
  const FreeBody body = Cube();
  const FreeBodyNumbers numbers = Ordinary();
  const FlightStart start = Thrown(50);
  const auto times = Evenly(2, 2001);
  const auto poses = FlyPlainly(body, numbers, start, times);
  const auto momentum = [&](std::size_t i) {
    const std::array<double, 4> back{poses[i - 1][3], -poses[i - 1][4], -poses[i - 1][5], -poses[i - 1][6]};
    const auto turn = Product(back.data(), poses[i + 1].data() + 3);
    const double gap = times[i + 1] - times[i - 1];
    const Triple<double> own{2 * body.inertia[0] * turn[1] / gap, 2 * body.inertia[1] * turn[2] / gap,
                             2 * body.inertia[2] * turn[3] / gap};
    return Times(RotationOf(poses[i].data() + 3), own);
  };
  const auto first = momentum(1);
  const auto last = momentum(times.size() - 2);
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(last[k], first[k], 2e-5 * 5e-3) << k;
}

// On four corners, m g = 4 k x^1.5.
TEST(FreeBodyFlightTest, RestsWhereTheSpringsCarryIt) {
  FreeBody body = Cube();
  FlightStart start;
  start.pose = {0, 0, 0.0502, 1, 0, 0, 0};
  const FreeBodyNumbers numbers = Ordinary();
  const auto vertices = FlyPlainly(body, numbers, start, Evenly(5, 6));
  EXPECT_NEAR(0.05 - vertices.back()[2], std::pow(body.mass * body.gravity / 4 / 3e5, 2.0 / 3), 1e-8);
  // On one face, m g = k A x.
  body = Cube(FreeBodyContact::kElasticFoundation);
  const auto faces = FlyPlainly(body, Ordinary(body.contact), start, Evenly(5, 6));
  EXPECT_NEAR(0.05 - faces.back()[2], body.mass * body.gravity / (2e9 * 0.01), 1e-9);
}

// Coulomb: v falls by mu g t.
TEST(FreeBodyFlightTest, SlidesToRestByFriction) {
  FreeBody body = Cube();
  body.inertia *= 1e4;  // it shall not tip
  FlightStart start;
  start.pose = {0, 0, 0.05 - std::pow(body.mass * body.gravity / 4 / 3e5, 2.0 / 3), 1, 0, 0, 0};
  start.velocity << 0.6, 0, 0;
  const FreeBodyNumbers numbers = Ordinary();
  const auto poses = FlyPlainly(body, numbers, start, Evenly(0.5, 6));
  const double way = 0.36 / (2 * 0.3 * body.gravity);
  EXPECT_NEAR(poses.back()[0], way, 0.01 * way);
}

TEST(FreeBodyFlightTest, LosesEnergyToContactOnly) {
  const FreeBody body = Cube();
  FlightStart start;
  start.pose = {0, 0, 0.15, 1, 0, 0, 0};
  FreeBodyNumbers elastic = Ordinary();
  elastic.value[kDissipation] = 0;
  const auto poses = FlyPlainly(body, elastic, start, Evenly(0.6, 6001));
  double highest = 0;
  for (std::size_t i = 2000; i < poses.size(); ++i) highest = std::max(highest, poses[i][2]);
  EXPECT_NEAR(highest, 0.15, 1e-6);
}

// Every slot against central differences, over an impact.
class FreeBodyDerivativeTest : public testing::TestWithParam<FreeBodyContact> {};

TEST_P(FreeBodyDerivativeTest, AgreesWithDifferences) {
  FreeBody body = Cube(GetParam());
  body.accuracy = 1e-12;
  const bool vertices = body.contact == FreeBodyContact::kVertices;
  FreeBodyNumbers at = Ordinary(body.contact);
  const double around[kFreeBodySlots] = {at.value[kStiffness],
                                         1,
                                         0.3,
                                         0.1,
                                         0.05,
                                         0.2,
                                         0.1,
                                         vertices ? 0.004 : 0,
                                         0.02,
                                         0.1,
                                         0.001,
                                         0.002,
                                         -0.001,
                                         0.05,
                                         0.01,
                                         0.01,
                                         -0.02,
                                         0.001,
                                         0.01,
                                         -0.01,
                                         0.02,
                                         -0.01,
                                         0.004,
                                         0.02,
                                         0.01,
                                         -0.03,
                                         0.001,
                                         0.002,
                                         0.001,
                                         0,
                                         0.02,
                                         0.01,
                                         0,
                                         0.01,
                                         0,
                                         0,
                                         0,
                                         0.1,
                                         0.05,
                                         0.1,
                                         0,
                                         0.1,
                                         0};
  for (std::size_t i = 0; i < at.value.size(); ++i) at.value[i] = around[i];
  const FlightStart start = Thrown(0.11);
  const auto times = Evenly(0.12, 7);
  FlightLimits limits;
  limits.accuracy = body.accuracy;
  limits.most_steps = 1000000;
  std::array<bool, kFreeBodySlots> used;
  used.fill(true);
  const auto fly = [&](const FreeBodyNumbers& numbers) {
    std::vector<Pose> poses(times.size());
    EXPECT_TRUE(Fly(body, numbers.value, used, start, -1, times, limits, poses.data()));
    return poses;
  };
  for (int slot = 0; slot < kFreeBodySlots; ++slot) {
    if (slot == kCornerRadius && !vertices) continue;
    SCOPED_TRACE(slot);
    const auto place = static_cast<std::size_t>(slot);
    std::array<Dual<4>, kFreeBodySlots> variables;
    for (std::size_t i = 0; i < variables.size(); ++i) variables[i] = at.value[i];
    variables[place].d[0] = 1;
    std::vector<std::array<Dual<4>, kPoseChannels>> exact(times.size());
    ASSERT_TRUE(Fly(body, variables, used, start, -1, times, limits, exact.data()));
    const double step = 3e-5 * std::max(0.1, std::abs(at.value[place]));
    FreeBodyNumbers above = at;
    above.value[place] += step;
    FreeBodyNumbers below = at;
    below.value[place] -= step;
    const auto up = fly(above);
    const auto down = fly(below);
    double size = 0;
    double worst = 0;
    for (std::size_t i = 0; i < times.size(); ++i) {
      for (std::size_t c = 0; c < kPoseChannels; ++c) {
        const double slope = (up[i][c] - down[i][c]) / (2 * step);
        size = std::max(size, std::abs(slope));
        worst = std::max(worst, std::abs(slope - exact[i][c].d[0]));
      }
    }
    // Kinks (slip that passes the transition velocity, a corner that comes to touch) spoil differences by 1
    // %.
    EXPECT_LE(worst, 2e-2 * size + 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(Contacts, FreeBodyDerivativeTest,
                         testing::Values(FreeBodyContact::kVertices, FreeBodyContact::kElasticFoundation));

TEST(FreeBodyFlightTest, ABudgetOfStepsIsKept) {
  const FreeBody body = Cube();
  const FreeBodyNumbers numbers = Ordinary();
  FlightLimits limits;
  limits.accuracy = 1e-10;
  limits.most_steps = 100;
  const auto times = Evenly(1, 11);
  std::vector<Pose> poses(times.size());
  const Status status =
      Fly(body, numbers.value, numbers.Used(), Thrown(0.1), -1, times, limits, poses.data());
  ASSERT_FALSE(status);
  EXPECT_THAT(status.error().message, testing::HasSubstr("more than 100 steps of the integrator at t = "));
}

TEST(FreeBodyFlightTest, TheBudgetOfStepsIsThatOfTheSettings) {
  FreeBody body = Cube();
  EXPECT_EQ(FlightLimits::For(body, 10).most_steps, 600);
  body.most_steps = 77;
  EXPECT_EQ(FlightLimits::For(body, 10).most_steps, 77);
}

struct Made {
  std::unique_ptr<FreeBodyProblem> problem;
  Dataset data;
};

Made Make(const std::map<std::string, double>& set,
          const std::vector<std::pair<std::string, std::map<std::string, double>>>& effects = {}) {
  SynthesisRequest request;
  request.set = set;
  request.effects = effects;
  auto data = SynthesizeFreeBody(request);
  EXPECT_TRUE(data) << data.error().message;
  const auto yaml = YamlReader::Parse(data->files.at("free_body.yaml"), "free_body.yaml");
  const auto settings = ReadFreeBodySettings(*yaml->At("free_body"));
  EXPECT_TRUE(settings) << settings.error().message;
  auto problem = FreeBodyProblem::Make(*data, *settings);
  EXPECT_TRUE(problem) << problem.error().message;
  return {std::move(*problem), std::move(*data)};
}

Vector Point(const FreeBodyProblem& problem, const std::map<std::string, double>& values) {
  Vector point = RestPoint(problem);
  for (const auto& [name, value] : values) point[*FindParameter(problem.parameters(), name)] = value;
  return point;
}

double CostAt(const FreeBodyProblem& problem, const Vector& point) {
  FitSetup setup;
  setup.parameters = problem.parameters();
  setup.rest = point;
  const LeastSquares fit(problem, setup);
  auto workspace = fit.NewWorkspace();
  Vector residuals;
  EXPECT_TRUE(fit.Evaluate(Vector(0), workspace, residuals, nullptr));
  return 0.5 * residuals.squaredNorm();
}

// What the states take up is gone from the derivatives, so that their product with the residual is the slope
// of the cost over fitted states.
TEST(FreeBodyProblemTest, GradientIsThatOfTheCostOverFittedStates) {
  const Made made = Make({{"train", 2}, {"validate", 0}, {"horizon", 0.1}, {"stiffness", 2e5}});
  const FreeBodyProblem& problem = *made.problem;
  const std::map<std::string, double> at{{"stiffness", 1.8e5}, {"dissipation", 1.4}, {"friction", 0.22}};
  for (const char* name : {"friction", "dissipation", "length_scale", "mass_centre_x", "inertia_error"}) {
    SCOPED_TRACE(name);
    const int index = *FindParameter(problem.parameters(), name);
    FitSetup setup;
    setup.parameters = problem.parameters();
    setup.rest = Point(problem, at);
    setup.free = {index};
    const LeastSquares fit(problem, setup);
    auto workspace = fit.NewWorkspace();
    SparseJacobian jacobian = fit.NewJacobian();
    Vector residuals;
    ASSERT_TRUE(fit.Evaluate(fit.Start(), workspace, residuals, &jacobian));
    const double slope =
        (jacobian.Dense(fit.residuals(), 1).transpose() * residuals)[0] / fit.Slopes(fit.Start())[0];
    const Parameter& p = problem.parameters()[static_cast<std::size_t>(index)];
    // The cost has noise of a hundred-thousandth, which is a tenth of what a step of 3e-5 changes here.
    const double step = 3e-4 * (p.upper - p.lower);
    Vector up = setup.rest;
    Vector down = setup.rest;
    up[index] += step;
    down[index] -= step;
    const double difference = (CostAt(problem, up) - CostAt(problem, down)) / (2 * step);
    EXPECT_NEAR(slope, difference, 0.02 * std::abs(difference) + 1e-3);
  }
}

// Several fits ask for the same point: with its state at hand it is the same to the last bit.
TEST(FreeBodyProblemTest, AStateThatIsKnownGivesTheSamePrediction) {
  const Made made = Make({{"train", 2}, {"validate", 0}, {"horizon", 0.1}});
  const Made other = Make({{"train", 2}, {"validate", 0}, {"horizon", 0.1}});
  const auto residuals_of = [](const FreeBodyProblem& problem, Vector& gradient) {
    FitSetup setup;
    setup.parameters = problem.parameters();
    setup.rest = Point(problem, {{"friction", 0.25}});
    setup.free = {*FindParameter(problem.parameters(), "stiffness"),
                  *FindParameter(problem.parameters(), "inertia_error")};
    const LeastSquares fit(problem, setup);
    auto workspace = fit.NewWorkspace();
    SparseJacobian jacobian = fit.NewJacobian();
    Vector residuals;
    EXPECT_TRUE(fit.Evaluate(fit.Start(), workspace, residuals, &jacobian));
    gradient = jacobian.Dense(fit.residuals(), 2).transpose() * residuals;
    return residuals;
  };
  Vector anew_gradient;
  Vector known_gradient;
  Vector other_gradient;
  const Vector anew = residuals_of(*made.problem, anew_gradient);
  EXPECT_EQ(residuals_of(*made.problem, known_gradient), anew);
  EXPECT_EQ(residuals_of(*other.problem, other_gradient), anew);
  EXPECT_EQ(known_gradient, anew_gradient);
  EXPECT_EQ(other_gradient, anew_gradient);
}

// A state is sought from what was found at a point nearby, which is chosen by the parameters alone.
TEST(FreeBodyProblemTest, APredictionDoesNotDependOnEarlierOnes) {
  const Made made = Make({{"train", 2}, {"validate", 0}, {"horizon", 0.1}});
  const Made other = Make({{"train", 2}, {"validate", 0}, {"horizon", 0.1}});
  const std::map<std::string, double> asked{{"friction", 0.24}, {"mass_centre_x", 2e-3}};
  for (const double friction : {0.15, 0.23, 0.26}) {
    CostAt(*made.problem, Point(*made.problem, {{"friction", friction}}));
    CostAt(*made.problem, Point(*made.problem, {{"friction", friction}, {"inertia_error", 0.1}}));
  }
  EXPECT_EQ(CostAt(*made.problem, Point(*made.problem, asked)),
            CostAt(*other.problem, Point(*other.problem, asked)));
}

TEST(FreeBodyProblemTest, FindsTheTruthBehindNoise) {
  const Made made = Make({{"train", 5}, {"validate", 0}});
  const FreeBodyProblem& problem = *made.problem;
  FitSetup setup;
  setup.parameters = problem.parameters();
  setup.rest = RestPoint(problem);
  setup.free = {0, 1, 2};
  const LeastSquares fit(problem, setup);
  solvers::LocalFit search(fit);
  const auto found = search.Minimize(fit.Start(), -1, {0, 1e-8}, 100);
  ASSERT_EQ(found.failure, "");
  const Vector point = fit.Parameters(found.x);
  EXPECT_NEAR(point[0], 1e6, 0.05e6);
  EXPECT_NEAR(point[1], 1.5, 0.03);
  EXPECT_NEAR(point[2], 0.2, 0.003);
}

// Windows start anew in flight; what they fit is their own.
TEST(FreeBodyProblemTest, WindowsCoverEveryComparedFrameOnce) {
  const Made made =
      Make({{"train", 3}, {"validate", 1}, {"window", 0.15}, {"horizon", 0}, {"dissipation", 0.3}});
  const FreeBodyData& data = made.problem->data();
  EXPECT_GT(data.windows.size(), data.tosses.size());
  std::vector<int> next(data.tosses.size(), 0);
  for (const TossWindow& window : data.windows) {
    int& at = next[static_cast<std::size_t>(window.toss)];
    EXPECT_EQ(window.first, at);
    at += static_cast<int>(window.times.size());
  }
  for (std::size_t t = 0; t < next.size(); ++t) EXPECT_EQ(next[t], data.tosses[t].compared);
}

TEST(FreeBodyProblemTest, FramesThatJumpAndFramesInTheHandAreLeftOut) {
  Made made = Make({{"train", 1}, {"validate", 0}});
  Grid& grid = made.data.trials.begin()->second.grids.begin()->second;
  const auto frames = made.problem->data().tosses.front().times.size();
  grid.channels["position_x"].values[20] += 0.05;
  // Held still for 20 frames before it is let go.
  const double gap = grid.time[1] - grid.time[0];
  for (double& t : grid.time) t += 20 * gap;
  for (int i = 20; i-- > 0;) grid.time.insert(grid.time.begin(), i * gap);
  for (auto& [name, channel] : grid.channels)
    channel.values.insert(channel.values.begin(), 20, channel.values.front());
  const auto yaml = YamlReader::Parse(made.data.files.at("free_body.yaml"), "free_body.yaml");
  auto problem = FreeBodyProblem::Make(made.data, *ReadFreeBodySettings(*yaml->At("free_body")));
  ASSERT_TRUE(problem) << problem.error().message;
  const FreeBodyData& data = (*problem)->data();
  ASSERT_EQ(data.notes.size(), 2U) << data.notes.front();
  EXPECT_THAT(data.notes[0], testing::HasSubstr("1 frame that jumps away and back is left out"));
  EXPECT_THAT(data.notes[1], testing::HasSubstr("begins in the hand"));
  EXPECT_NEAR(static_cast<double>(data.tosses.front().times.size()), static_cast<double>(frames), 4);
}

TEST(FreeBodyProblemTest, AFewFramesInARowThatJumpAreLeftOut) {
  for (const int count : {2, 3}) {
    Made made = Make({{"train", 1}, {"validate", 0}});
    const auto whole = made.problem->data().tosses.front().times;
    Grid& grid = made.data.trials.begin()->second.grids.begin()->second;
    std::vector<double> expected = whole;
    for (int i = 30; i < 30 + count; ++i) {
      grid.channels["position_y"].values[static_cast<std::size_t>(i)] -= 0.1;
      expected.erase(std::find(expected.begin(), expected.end(), grid.time[static_cast<std::size_t>(i)]));
    }
    const auto yaml = YamlReader::Parse(made.data.files.at("free_body.yaml"), "free_body.yaml");
    auto problem = FreeBodyProblem::Make(made.data, *ReadFreeBodySettings(*yaml->At("free_body")));
    ASSERT_TRUE(problem) << problem.error().message;
    EXPECT_EQ((*problem)->data().tosses.front().times, expected) << count;
  }
}

TEST(FreeBodyProblemTest, WrongDataGetOneSentence) {
  const auto failure = [](const std::function<void(Dataset&)>& spoil) {
    Made made = Make({{"train", 1}, {"validate", 0}});
    spoil(made.data);
    const auto yaml = YamlReader::Parse(made.data.files.at("free_body.yaml"), "free_body.yaml");
    const auto problem = FreeBodyProblem::Make(made.data, *ReadFreeBodySettings(*yaml->At("free_body")));
    return problem ? std::string() : problem.error().message;
  };
  const auto grid = [](Dataset& data) -> Grid& { return data.trials.begin()->second.grids.begin()->second; };
  EXPECT_EQ(failure([&](Dataset& data) { grid(data).channels.erase("orientation_y"); }),
            "trial 'train_1': has no channel 'orientation_y'");
  EXPECT_EQ(failure([&](Dataset& data) { grid(data).channels["position_x"].unit = "rad"; }),
            "trial 'train_1': channel 'position_x' has the unit rad, expected m");
  EXPECT_THAT(failure([&](Dataset& data) {
                for (double& w : grid(data).channels["orientation_w"].values) w = 3;
              }),
              testing::HasSubstr("orientation at t = 0 s has the length"));
  EXPECT_THAT(failure([&](Dataset& data) {
                for (double& z : grid(data).channels["position_z"].values) z += 10;
              }),
              testing::HasSubstr("never comes near the table"));
  EXPECT_THAT(failure([&](Dataset& data) {
                for (double& z : grid(data).channels["position_z"].values) z = NAN;
              }),
              testing::HasSubstr("has 0 frames with a pose"));
  EXPECT_EQ(failure([&](Dataset& data) { data.trials.clear(); }), "holds no trial");
}

TEST(FreeBodySettingsTest, WrongWordsGetTheirLine) {
  const auto failure = [](const std::string& text) {
    const auto yaml = YamlReader::Parse("free_body:\n" + text, "f.yaml");
    const auto settings = ReadFreeBodySettings(*yaml->At("free_body"));
    return settings ? std::string() : settings.error().message;
  };
  const std::string good = "  box: [0.1, 0.1, 0.1]\n  mass: 0.4\n";
  EXPECT_EQ(failure(good), "");
  EXPECT_THAT(failure("  mass: 1\n"), testing::HasSubstr("box"));
  EXPECT_THAT(failure("  box: [0.1, 0.1, 0.1]\n"), testing::HasSubstr("mass"));
  EXPECT_THAT(failure(good + "  windw: 1\n"), testing::HasSubstr("window"));
  EXPECT_THAT(failure(good + "  contact: vertex\n"),
              testing::HasSubstr("f.yaml:4: contact: 'vertex' does not exist"));
  EXPECT_THAT(failure(good + "  inertia: [1, 1, 3]\n"), testing::HasSubstr("no body has such moments"));
  EXPECT_THAT(failure(good + "  accuracy: 1\n"),
              testing::HasSubstr("f.yaml:4: accuracy: 1, expected 1e-12 to 0.01"));
  EXPECT_THAT(failure(good + "  most_steps: -1\n"),
              testing::HasSubstr("f.yaml:4: most_steps: -1, expected 0 to 1000000000"));
  const auto few = YamlReader::Parse("free_body:\n" + good + "  most_steps: 50\n", "f.yaml");
  EXPECT_EQ(ReadFreeBodySettings(*few->At("free_body"))->body.most_steps, 50);
  EXPECT_THAT(failure(good + "  divisions: 2.5\n"), testing::HasSubstr("expected a whole number"));
  EXPECT_THAT(failure("  box: [0.1, 0, 0.1]\n  mass: 0.4\n"), testing::HasSubstr("expected numbers above 0"));
}

}  // namespace
}  // namespace sinew
