// A mass driven by a force that is recorded with noise: the prediction is a random walk about the truth, far
// beyond the noise of the position, and no misfit.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/constants.h"
#include "base/random.h"
#include "identify/diagnosis/diagnosis.h"
#include "identify/fit_setup.h"
#include "identify/noise/input_noise.h"
#include "problems/drive/data/input_noise.h"
#include "problems/drive/problem.h"
#include "tests/identify/support/error_of.h"

namespace sinew {
namespace {

constexpr double kForceRate = 250;
constexpr double kAxisMass = 5;
constexpr double kAxisViscous = 15;
constexpr double kForceNoise = 0.2;
constexpr double kPositionNoise = 2e-5;

double Force(double t, int trial) {
  return 6 * std::sin(2.6 * t + trial) + 4 * std::sin((7.1 + trial) * t) + 3 * std::cos((4.3 - trial) * t);
}

// Exact but for steps of 0.1 ms; the recorded force is that which acted, and noise.
Dataset Axis(std::uint64_t seed, double coulomb, double force_noise = kForceNoise) {
  Dataset data;
  Random random(seed);
  for (int i = 0; i < 3; ++i) {
    Trial& trial = data.trials["trial" + std::to_string(i)];
    trial.role = i < 2 ? Role::kTrain : Role::kValidate;
    Grid& grid = trial.grids["axis"];
    Channel position{"m", ChannelKind::kMeasured, {}, {}};
    Channel force{"N", ChannelKind::kInput, {}, {}};
    if (force_noise > 0) force.sigma = force_noise;
    constexpr int kSteps = 40;
    constexpr double kStep = 1 / (kForceRate * kSteps);
    double x = 0;
    double v = 0.3;
    for (int k = 0; k <= static_cast<int>(10 * kForceRate); ++k) {
      const double t = k / kForceRate;
      grid.time.push_back(t);
      position.values.push_back(x + kPositionNoise * random.Normal());
      force.values.push_back(Force(t, i) + force_noise * random.Normal());
      for (int s = 0; s < kSteps; ++s) {
        const double drive = Force(t + (s + 0.5) * kStep, i);
        double before = v;
        const auto slope = [&](double speed) {
          return (drive - kAxisViscous * speed - std::copysign(coulomb, speed)) / kAxisMass;
        };
        v += kStep * slope(v + 0.5 * kStep * slope(v));
        if (coulomb > 0 && before * v < 0 && std::abs(drive) < coulomb) v = 0;
        x += 0.5 * kStep * (before + v);
      }
    }
    grid.channels["position"] = position;
    grid.channels["force"] = force;
  }
  return data;
}

std::unique_ptr<DriveProblem> Bind(const Dataset& data) {
  auto problem = DriveProblem::Make(data, {}, 0.1);
  EXPECT_TRUE(problem) << ErrorOf(problem);
  return problem ? std::move(*problem) : nullptr;
}

Diagnosis DiagnosisOf(const DriveProblem& problem) {
  auto diagnosis = Diagnose(problem, MakeFitSetup(problem, {}).value(), {});
  EXPECT_TRUE(diagnosis) << ErrorOf(diagnosis);
  return diagnosis ? *diagnosis : Diagnosis{};
}

std::vector<double> Record(double noise, double frequency, std::vector<double>& time) {
  Random random(3);
  std::vector<double> values;
  time.clear();
  for (int i = 0; i < 3000; ++i) {
    time.push_back(i / kForceRate);
    values.push_back(std::sin(2 * kPi * frequency * time.back()) + noise * random.Normal());
  }
  return values;
}

double Rms(const std::vector<double>& values, double frequency) {
  double sum = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
    sum += std::pow(values[i] - std::sin(2 * kPi * frequency * static_cast<double>(i) / kForceRate), 2);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

TEST(InputNoise, IsSmoothedAwayWhereTheRecordHoldsNothingElse) {
  std::vector<double> time;
  for (const double frequency : {0.5, 2.0, 8.0}) {
    std::vector<double> values = Record(0.05, frequency, time);
    const InputNoise noise = SmoothInput(time, values, 0.05);
    EXPECT_EQ(noise.level, 0.05);
    EXPECT_GT(noise.cutoff * kForceRate, frequency);
    EXPECT_LT(noise.cutoff * kForceRate, 6 * frequency + 3);
    EXPECT_LT(Rms(values, frequency), 1.3 * 0.05 * std::sqrt(2 * noise.cutoff)) << frequency;
  }
}

TEST(InputNoise, OtherRecordsStayAsTheyAre) {
  std::vector<double> time;
  const auto unchanged = [&](std::vector<double> values, double stated) {
    const std::vector<double> before = values;
    const InputNoise noise = SmoothInput(time, values, stated);
    EXPECT_EQ(noise.level, stated);
    EXPECT_EQ(noise.cutoff, 0);
    EXPECT_EQ(values, before);
  };
  unchanged(Record(0, 2, time), 0.05);    // filtered
  unchanged(Record(0.5, 2, time), 0.05);  // more than noise, as an excitation by white noise
  std::vector<double> values = Record(0.05, 2, time);
  values.resize(60);
  time.resize(60);
  unchanged(values, 0.05);
  values = Record(0.05, 2, time);
  time[1000] += 0.3 / kForceRate;
  unchanged(values, 0.05);
}

TEST(InputNoise, TheFilterKeepsStraightLinesToTheirEnds) {
  std::vector<double> line;
  for (int i = 0; i < 500; ++i) line.push_back(3 - 0.01 * i);
  const std::vector<double> smooth = LowPass(line, 0.02);
  for (std::size_t i = 0; i < line.size(); ++i) EXPECT_NEAR(smooth[i], line[i], 1e-9);
}

TEST(InputNoise, SpreadsThePredictionAsTheClosedFormSays) {
  const auto problem = Bind(Axis(1, 0));
  Vector at = RestPoint(*problem);
  at[0] = kAxisMass;
  at[1] = 1e-3;  // nearly no friction: the speed is a random walk
  const auto workspace = problem->NewWorkspace();
  const std::vector<bool> all(problem->layout().size(), true);
  Prediction without(problem->layout());
  ASSERT_TRUE(problem->Predict({at, all, false, nullptr}, *workspace, without));
  Prediction with(problem->layout());
  double square = 0;
  constexpr int kDraws = 100;
  const auto n = without.values(0).size();
  for (int draw = 0; draw < kDraws; ++draw) {
    const auto noisy = problem->PredictWithInputNoise({at, all, false, nullptr},
                                                      static_cast<std::uint64_t>(draw), *workspace, with);
    ASSERT_TRUE(noisy && *noisy);
    square += std::pow(with.values(0)[n - 1] - without.values(0)[n - 1], 2) / kDraws;
  }
  // Twice integrated white noise: variance = noise^2 interval t^3 / 3 / mass^2.
  const double t = problem->layout()[0].prediction_time.back();
  const double expected = kForceNoise / kAxisMass * std::sqrt(t * t * t / 3 / kForceRate);
  EXPECT_NEAR(std::sqrt(square), expected, 0.25 * expected);
}

TEST(InputNoise, IsNoneWhereNoLevelIsStated) {
  const auto problem = Bind(Axis(1, 0, 0));
  const auto workspace = problem->NewWorkspace();
  const std::vector<bool> all(problem->layout().size(), true);
  Prediction prediction(problem->layout());
  const Vector at = RestPoint(*problem);
  const auto noisy = problem->PredictWithInputNoise({at, all, false, nullptr}, 0, *workspace, prediction);
  ASSERT_TRUE(noisy);
  EXPECT_FALSE(*noisy);
}

TEST(InputNoise, OfTheForceIsNoMisfit) {
  for (const std::uint64_t seed : {1, 2}) {
    const auto problem = Bind(Axis(seed, 0));
    const Diagnosis d = DiagnosisOf(*problem);
    EXPECT_EQ(d.verdict, DiagnosisVerdict::kAdequate) << seed;
    ASSERT_EQ(d.noise.size(), 1U);
    EXPECT_EQ(d.noise[0].basis, NoiseBasis::kInputs);
    EXPECT_GT(d.noise[0].sigma, 10 * kPositionNoise);
  }
}

TEST(InputNoise, HidesNoFriction) {
  const double coulomb = 1.5;
  const auto problem = Bind(Axis(4, coulomb));
  const Diagnosis d = DiagnosisOf(*problem);
  EXPECT_NE(d.verdict, DiagnosisVerdict::kAdequate);
  ASSERT_EQ(d.causes.size(), 1U);
  EXPECT_EQ(d.causes[0].effect, "coulomb_friction");
  const DiagnosedParameter& found = d.causes[0].parameters[0];
  EXPECT_NEAR(found.value, coulomb, 4 * found.std_error);
  EXPECT_LT(found.std_error, 0.02 * coulomb);
}

}  // namespace
}  // namespace sinew
