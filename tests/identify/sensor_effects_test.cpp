#include "identify/observation/sensor_effects.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "identify/fit_setup.h"
#include "tests/identify/support/error_of.h"
#include "tests/identify/support/toy_problem.h"

namespace sinew {
namespace {

using toy::MakeBlock;
using toy::MakeParameter;
using toy::ToyProblem;
using toy::Values;

constexpr double kDuration = 2;  // [s]
constexpr int kSamples = 201;
constexpr double kAngularFrequency = 2 * M_PI;

double Sine(double amplitude, double phase, double t) {
  return amplitude * std::sin(kAngularFrequency * t + phase);
}

// Two channels of two trials and one that is only predicted: sines of a common amplitude and phase.
std::unique_ptr<ToyProblem> Sines() {
  auto problem = std::make_unique<ToyProblem>(
      std::vector<Parameter>{MakeParameter("amplitude", 0.5, 4, 1), MakeParameter("phase", -1, 1, 0)},
      Layout{MakeBlock("one", "y", kSamples, kDuration), MakeBlock("one", "z", kSamples, kDuration),
             MakeBlock("two", "y", kSamples, kDuration, BlockRole::kValidate),
             MakeBlock("one", "w", kSamples, kDuration, BlockRole::kPredicted)},
      [](const Block& block, double t, const Vector& p, Vector* gradient) -> Result<double> {
        if (p[0] > 3.9) return Fail("the amplitude {} is too large", p[0]);
        const double phase = block.channel == "y" ? p[1] : p[1] + 0.5;
        if (gradient != nullptr) *gradient << Sine(1, phase, t), Sine(p[0], phase + M_PI / 2, t);
        return Sine(p[0], phase, t);
      },
      std::vector<Constraint>{{"some", Values({1, 2}), -9}});
  problem->Measure(Values({2, 0.1}), [](const Block&, int) { return 0.0; });
  return problem;
}

// Parameters: the inner two, then offset, drift, gain and time_offset of y, then of z.
enum Index { kAmplitude, kPhase, kOffset, kDrift, kGain, kTimeOffset, kOfZ, kCount = kOfZ + 4 };

Prediction PredictAt(const Problem& problem, const Vector& parameters) {
  Prediction prediction(problem.layout());
  const auto workspace = problem.NewWorkspace();
  const std::vector<bool> all(problem.layout().size(), true);
  EXPECT_TRUE(problem.Predict({parameters, all, true, nullptr}, *workspace, prediction));
  return prediction;
}

TEST(SensorEffects, AreFourPerComparedChannelSharedByItsTrials) {
  const SensorEffects problem(Sines());
  ASSERT_EQ(problem.parameters().size(), static_cast<std::size_t>(kCount));
  EXPECT_EQ(ErrorOf(CheckParameters(problem.parameters())), "");
  EXPECT_EQ(ErrorOf(CheckLayout(problem.layout(), kCount)), "");
  EXPECT_EQ(problem.parameters()[kOffset].name, "y.offset");
  EXPECT_EQ(problem.parameters()[kDrift].unit, "1/s");
  EXPECT_EQ(problem.parameters()[kGain].null_value, 1);
  EXPECT_EQ(problem.parameters()[kOfZ + 3].name, "z.time_offset");
  EXPECT_EQ(problem.layout()[0].columns, (std::vector<int>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(problem.layout()[1].columns, (std::vector<int>{0, 1, 6, 7, 8, 9}));
  EXPECT_EQ(problem.layout()[2].columns, problem.layout()[0].columns);
  EXPECT_EQ(problem.layout()[3].columns, (std::vector<int>{0, 1}));
}

TEST(SensorEffects, AreReleasedByName) {
  const SensorEffects problem(Sines());
  ASSERT_EQ(problem.effects().size(), 8U);
  for (const Effect& effect : problem.effects()) {
    EXPECT_EQ(effect.level, Level::kSensor);
    EXPECT_FALSE(effect.says.empty());
    EXPECT_FALSE(effect.exposed_by.empty());
    FitRequest request;
    request.release = {effect.name};
    const auto setup = MakeFitSetup(problem, request);
    ASSERT_TRUE(setup) << setup.error().message;
    ASSERT_EQ(effect.parameters.size(), 1U);
    EXPECT_EQ(setup->free, (std::vector<int>{kAmplitude, kPhase, effect.parameters[0]}));
  }
}

TEST(SensorEffects, TheNullPassesToTheLastBit) {
  const auto bare = Sines();
  const SensorEffects problem(Sines());
  Random random(1);
  for (int round = 0; round < 20; ++round) {
    Vector p = RestPoint(problem);
    p[kAmplitude] = random.Uniform(0.5, 3.9);
    p[kPhase] = random.Uniform(-1, 1);
    const Prediction expected = PredictAt(*bare, p.head(2));
    const Prediction observed = PredictAt(problem, p);
    for (int b = 0; b < 4; ++b) {
      ASSERT_EQ(Vector(observed.values(b)), Vector(expected.values(b)));
      ASSERT_EQ(Matrix(observed.derivatives(b).leftCols(2)), Matrix(expected.derivatives(b)));
    }
  }
}

TEST(SensorEffects, OffsetDriftAndGainAreTheirFormula) {
  constexpr double kRounding = 1e-15;
  const SensorEffects problem(Sines());
  Vector p = RestPoint(problem);
  const Prediction plain = PredictAt(problem, p);
  p[kOffset] = 0.5;
  p[kDrift] = -0.25;
  p[kGain] = 1.25;
  const Prediction observed = PredictAt(problem, p);
  for (int i = 0; i < kSamples; ++i) {
    const double t = problem.layout()[0].prediction_time[static_cast<std::size_t>(i)];
    const double expected = 1.25 * plain.values(0)[i] + 0.5 - 0.25 * (t - kDuration / 2);
    EXPECT_NEAR(observed.values(0)[i], expected, 4 * kRounding);
    EXPECT_EQ(observed.values(2)[i], observed.values(0)[i]) << "the same sensor in another trial";
    EXPECT_EQ(observed.values(1)[i], plain.values(1)[i]) << "the sensor of another channel";
  }
}

TEST(SensorEffects, ADelayedSineIsTheSineOfTheDelayedTime) {
  // Cubic interpolation: 5/384 h^4 w^4 = 2e-7 within; the natural ends, where the sine's second derivative is
  // not zero, decay by a factor of 3.7 per sample.
  constexpr double kTolerance = 5e-7;
  constexpr double kEnds = 0.25;  // [s]
  const SensorEffects problem(Sines());
  for (const double delay : {-0.07, -0.0031, 0.0123, 0.1}) {
    Vector p = RestPoint(problem);
    p[kPhase] = 0.3;
    p[kTimeOffset] = delay;
    const Prediction observed = PredictAt(problem, p);
    for (int i = 0; i < kSamples; ++i) {
      const double t = problem.layout()[0].prediction_time[static_cast<std::size_t>(i)];
      if (t < kEnds || t > kDuration - kEnds) continue;
      EXPECT_NEAR(observed.values(0)[i], Sine(1, 0.3, t - delay), kTolerance);
    }
  }
}

TEST(SensorEffects, JacobianAgreesWithDifferencesForEachEffect) {
  constexpr double kStep = 6e-6;  // cbrt(eps)
  constexpr double kTolerance =
      1e-8;  // error of central differences, with the sine's third derivative of 250
  const SensorEffects problem(Sines());
  Random random(2);
  for (int round = 0; round < 10; ++round) {
    Vector p = RestPoint(problem);
    p << random.Uniform(0.6, 3.8), random.Uniform(-0.9, 0.9), 0.3, -0.2, 1.3, random.Uniform(-0.09, 0.09),
        -0.3, 0.1, 0.8, 0;  // the last at its null, where another branch is taken
    const Prediction at = PredictAt(problem, p);
    for (int k = 0; k < kCount; ++k) {
      const Prediction right = PredictAt(problem, p + kStep * Vector::Unit(kCount, k));
      const Prediction left = PredictAt(problem, p - kStep * Vector::Unit(kCount, k));
      for (int b = 0; b < 4; ++b) {
        const auto& columns = problem.layout()[static_cast<std::size_t>(b)].columns;
        const auto found = std::find(columns.begin(), columns.end(), k);
        const Vector difference = (right.values(b) - left.values(b)) / (2 * kStep);
        if (found == columns.end()) {
          EXPECT_EQ(difference.norm(), 0) << "block " << b << " depends on an undeclared parameter " << k;
          continue;
        }
        const Vector column = at.derivatives(b).col(found - columns.begin());
        EXPECT_LT((column - difference).norm(), kTolerance * (1 + difference.norm()))
            << "block " << b << ", parameter " << problem.parameters()[static_cast<std::size_t>(k)].name;
      }
    }
  }
}

TEST(SensorEffects, ASingleSampleHasNoSlope) {
  Block block = MakeBlock("one", "y", 2, 1);
  block.prediction_time.pop_back();
  block.sample.pop_back();
  block.measured.pop_back();
  const SensorEffects problem(std::make_unique<ToyProblem>(
      std::vector<Parameter>{MakeParameter("a", 0, 1, 0.5)}, Layout{block},
      [](const Block&, double, const Vector& p, Vector* gradient) -> Result<double> {
        if (gradient != nullptr) *gradient << 1;
        return p[0];
      }));
  const Prediction prediction = PredictAt(problem, RestPoint(problem));
  EXPECT_EQ(prediction.values(0)[0], 0.5);
  EXPECT_EQ(prediction.derivatives(0).row(0), Values({1, 1, 0, 0.5, 0}).transpose());
}

TEST(SensorEffects, FailuresOfTheProblemArePassedOn) {
  const SensorEffects problem(Sines());
  Vector p = RestPoint(problem);
  p[kAmplitude] = 4;
  Prediction prediction(problem.layout());
  const auto workspace = problem.NewWorkspace();
  EXPECT_EQ(ErrorOf(problem.Predict({p, std::vector<bool>(4, true), false, nullptr}, *workspace, prediction)),
            "the amplitude 4 is too large");
}

TEST(SensorEffects, ConstraintsDoNotDependOnSensors) {
  const SensorEffects problem(Sines());
  ASSERT_EQ(problem.constraints().size(), 1U);
  Vector expected = Vector::Zero(kCount);
  expected.head(2) << 1, 2;
  EXPECT_EQ(problem.constraints()[0].coefficients, expected);
  EXPECT_EQ(problem.constraints()[0].offset, -9);
}

}  // namespace
}  // namespace sinew
