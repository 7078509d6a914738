#include "identify/observation/sensor_effects.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

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

constexpr int kKnots = 8;
// Parameters: the inner two, then those of the sensor of y and the weights of its y(time), then of z.
enum Index { kAmplitude, kPhase, kOfY, kTimeOfY = kOfY + kSensorEffects, kOfZ = kTimeOfY + kKnots };
enum { kTimeOfZ = kOfZ + kSensorEffects, kCount = kTimeOfZ + kKnots };

std::vector<int> Columns(std::initializer_list<std::pair<int, int>> ranges) {
  std::vector<int> columns{kAmplitude, kPhase};
  for (const auto& [first, last] : ranges) {
    for (int i = first; i < last; ++i) columns.push_back(i);
  }
  return columns;
}

Prediction PredictAt(const Problem& problem, const Vector& parameters) {
  Prediction prediction(problem.layout());
  const auto workspace = problem.NewWorkspace();
  const std::vector<bool> all(problem.layout().size(), true);
  EXPECT_TRUE(problem.Predict({parameters, all, true, nullptr}, *workspace, prediction));
  return prediction;
}

TEST(SensorEffects, AreSevenPerComparedChannelSharedByItsTrials) {
  const SensorEffects problem(Sines());
  const auto& parameters = problem.parameters();
  ASSERT_EQ(parameters.size(), static_cast<std::size_t>(kCount));
  EXPECT_EQ(ErrorOf(CheckParameters(parameters)), "");
  EXPECT_EQ(ErrorOf(CheckLayout(problem.layout(), kCount)), "");
  EXPECT_EQ(parameters[kOfY + kOffset].name, "y.offset");
  EXPECT_EQ(parameters[kOfY + kDrift].unit, "1/s");
  EXPECT_EQ(parameters[kOfY + kGain].null_value, 1);
  EXPECT_EQ(parameters[kOfY + kLowPass].lower, 0);
  EXPECT_EQ(parameters[kOfY + kLowPass].null_value, 0);
  EXPECT_EQ(parameters[kOfZ + kTimeOffset].name, "z.time_offset");
  EXPECT_EQ(problem.layout()[0].columns, Columns({{kOfY, kOfZ}}));
  EXPECT_EQ(problem.layout()[1].columns, Columns({{kOfZ, kCount}}));
  EXPECT_EQ(problem.layout()[2].columns, problem.layout()[0].columns);
  EXPECT_EQ(problem.layout()[3].columns, Columns({}));
}

TEST(SensorEffects, AreReleasedByName) {
  const SensorEffects problem(Sines());
  ASSERT_EQ(problem.effects().size(), 2U * kSensorEffects);
  for (const Effect& effect : problem.effects()) {
    EXPECT_EQ(effect.level, Level::kSensor);
    EXPECT_FALSE(effect.description.empty());
    EXPECT_FALSE(effect.revealing_experiment.empty());
    EXPECT_TRUE(effect.trial.empty()) << "there is only one trial to fit";
    FitRequest request;
    request.release = {effect.name};
    const auto setup = MakeFitSetup(problem, request);
    ASSERT_TRUE(setup) << setup.error().message;
    ASSERT_EQ(effect.parameters.size(), 1U);
    EXPECT_EQ(setup->free, (std::vector<int>{kAmplitude, kPhase, effect.parameters[0]}));
  }
}

TEST(SensorEffects, TheNullChangesNothingToTheLastBit) {
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
  p[kOfY + kOffset] = 0.5;
  p[kOfY + kDrift] = -0.25;
  p[kOfY + kGain] = 1.25;
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
    p[kOfY + kTimeOffset] = delay;
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
    p.head(2) << random.Uniform(0.6, 3.8), random.Uniform(-0.9, 0.9);
    p.segment(kOfY, kTimeOffset + 1) << 0.3, -0.2, 1.3, random.Uniform(-0.09, 0.09);
    p.segment(kOfZ, kTimeOffset + 1) << -0.3, 0.1, 0.8, 0;  // at its null, where another branch is taken
    p[kOfY + kLowPass] = random.Uniform(0.03, 0.4);         // for shorter ones kStep is too long, see LowPass
    p[kOfZ + kLowPass] = round % 2 == 0 ? 0.03 : 0.1;
    for (int k = 0; k < kKnots; ++k) p[kTimeOfY + k] = random.Uniform(-0.5, 0.5);
    const Prediction at = PredictAt(problem, p);
    for (int k = 0; k < kCount; ++k) {
      if (k == kOfY + kSaturation || k == kOfZ + kSaturation) continue;      // at the null, see below
      if (k == kOfY + kQuantisation || k == kOfZ + kQuantisation) continue;  // see below
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
  // A time that does not pass gives no port.
  EXPECT_TRUE(problem.ports().empty());
  const Vector row = prediction.derivatives(0).row(0);
  EXPECT_EQ(row, Values({1, 1, 0, 0.5, 0, 0, 0, 0}));
  Vector late = RestPoint(problem);
  late[1 + kTimeOffset] = 0.05;
  late[1 + kLowPass] = 0.05;
  EXPECT_EQ(PredictAt(problem, late).values(0)[0], 0.5);
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

// The two-sided slope of the prediction of block 0 for parameter k.
Vector DifferenceOf(const Problem& problem, const Vector& p, int k, double step) {
  const Vector unit = Vector::Unit(p.size(), k);
  return (PredictAt(problem, p + step * unit).values(0) - PredictAt(problem, p - step * unit).values(0)) /
         (2 * step);
}

TEST(SensorEffects, ALowPassIsExactForItsRampAndLagsASine) {
  // A sine through a first-order lag, after the initial transient (8 time constants: 3e-4 of its size);
  // linear pieces of 0.01 s deviate from a sine by h^2 w^2 / 8 = 5e-4.
  constexpr double kTolerance = 1e-3;
  constexpr double kTimeConstant = 0.1;  // [s]
  const SensorEffects problem(Sines());
  Vector p = RestPoint(problem);
  p[kOfY + kLowPass] = kTimeConstant;
  const Prediction observed = PredictAt(problem, p);
  const double lag = std::atan(kAngularFrequency * kTimeConstant);
  for (int i = 80; i < kSamples; ++i) {
    const double t = problem.layout()[0].prediction_time[static_cast<std::size_t>(i)];
    EXPECT_NEAR(observed.values(0)[i], Sine(std::cos(lag), -lag, t), kTolerance);
  }
}

TEST(SensorEffects, LowPassComesBeforeTheTimeOffsetAndGainAfterBoth) {
  constexpr double kRounding = 1e-13;
  const SensorEffects problem(Sines());
  Vector p = RestPoint(problem);
  p[kOfY + kLowPass] = 0.04;
  const Vector smooth = PredictAt(problem, p).values(0);
  p[kOfY + kTimeOffset] = 0.05;  // five samples
  const Vector late = PredictAt(problem, p).values(0);
  p[kOfY + kGain] = 1.5;
  p[kOfY + kOffset] = 0.25;
  const Vector all = PredictAt(problem, p).values(0);
  EXPECT_LT((late.tail(kSamples - 5) - smooth.head(kSamples - 5)).cwiseAbs().maxCoeff(), kRounding);
  EXPECT_LT((all.array() - 1.5 * late.array() - 0.25).abs().maxCoeff(), kRounding);
}

TEST(SensorEffects, DerivativeForTheLowPassAtItsNullIsTheNegativeSlope) {
  // Straight pieces: the slope of the piece before, half a sample off (h/2 w^2 = 0.2).
  const SensorEffects problem(Sines());
  const Prediction at = PredictAt(problem, RestPoint(problem));
  const auto values = at.values(0);
  const auto column = at.derivatives(0).col(kOfY + kLowPass);
  EXPECT_DOUBLE_EQ(column[0], column[1]) << "straight before the first sample";
  for (int i = 1; i < kSamples; ++i) {
    const double t = problem.layout()[0].prediction_time[static_cast<std::size_t>(i)];
    const double h = t - problem.layout()[0].prediction_time[static_cast<std::size_t>(i) - 1];
    EXPECT_DOUBLE_EQ(column[i], -(values[i] - values[i - 1]) / h);
    EXPECT_NEAR(column[i], -Sine(kAngularFrequency, M_PI / 2, t), 0.25);
  }
}

TEST(SensorEffects, SaturationClipsTheReadingAndItsDerivatives) {
  constexpr double kStep = 1e-6;
  constexpr double kTolerance = 1e-8;  // differences: kStep^2, eps / kStep
  const SensorEffects problem(Sines());
  const Parameter& saturation = problem.parameters()[kOfY + kSaturation];
  EXPECT_EQ(saturation.unit, "1/1");
  ASSERT_EQ(saturation.probes.size(), 3U);
  EXPECT_GT(saturation.null_step, 0);
  double most = 0;
  for (const double value : problem.layout()[0].measured) most = std::max(most, std::abs(value));
  EXPECT_NEAR(1 / saturation.probes[1], 0.85 * most, 1e-12);

  Vector p = RestPoint(problem);
  p[kAmplitude] = 2;
  p[kOfY + kGain] = 1.1;
  p[kOfY + kTimeOffset] = 0.013;
  p[kOfY + kLowPass] = 0.02;
  const Prediction open = PredictAt(problem, p);
  p[kOfY + kSaturation] = 0.7;  // a limit of 1.43 on an amplitude of 2.2
  const Prediction clipped = PredictAt(problem, p);
  int count = 0;
  for (int i = 0; i < kSamples; ++i) {
    const double expected = std::max(-1 / 0.7, std::min(1 / 0.7, open.values(0)[i]));
    EXPECT_EQ(clipped.values(0)[i], expected);
    if (expected != open.values(0)[i]) ++count;
  }
  EXPECT_GT(count, 50);
  for (int c = 0; c < kOfZ; ++c) {
    if (c == kOfY + kQuantisation) continue;
    const Vector difference = DifferenceOf(problem, p, c, kStep);
    EXPECT_LT((difference - clipped.derivatives(0).col(c)).cwiseAbs().maxCoeff(), kTolerance * 100)
        << problem.parameters()[static_cast<std::size_t>(c)].name;
  }
}

TEST(SensorEffects, QuantisationRoundsAndKeepsTheDerivativesOfTheReading) {
  const SensorEffects problem(Sines());
  EXPECT_TRUE(problem.parameters()[kOfY + kQuantisation].probes.empty()) << "these values are continuous";
  Vector p = RestPoint(problem);
  p[kOfY + kOffset] = 0.1;
  const Prediction smooth = PredictAt(problem, p);
  p[kOfY + kQuantisation] = 0.25;
  const Prediction stepped = PredictAt(problem, p);
  for (int i = 0; i < kSamples; ++i) {
    EXPECT_EQ(std::fmod(stepped.values(0)[i], 0.25), 0);
    EXPECT_LE(std::abs(stepped.values(0)[i] - smooth.values(0)[i]), 0.125 + 1e-15);
  }
  EXPECT_EQ(Matrix(stepped.derivatives(0)), Matrix(smooth.derivatives(0)));
  EXPECT_EQ(Vector(stepped.derivatives(0).col(kOfY + kQuantisation)).norm(), 0);
}

TEST(SensorEffects, AHalfStepIsRoundedAwayFromZero) {
  auto inner = std::make_unique<ToyProblem>(
      std::vector<Parameter>{MakeParameter("a", -4, 4, 0)}, Layout{MakeBlock("one", "y", 4, 1)},
      [](const Block&, double t, const Vector& p, Vector*) -> Result<double> {
        return p[0] * (t < 0.5 ? 1 : -1);
      });
  const SensorEffects problem(std::move(inner));
  Vector p = RestPoint(problem);
  p[0] = 0.75;
  p[1 + kQuantisation] = 0.5;
  EXPECT_EQ(PredictAt(problem, p).values(0)[0], 1);
  EXPECT_EQ(PredictAt(problem, p).values(0)[3], -1);
}

TEST(SensorEffects, QuantisedMeasurementsGiveTheProbeValue) {
  constexpr double kStep = 0.125;
  auto inner = Sines();
  // Noise before the rounding, as in a sensor.
  inner->Measure(Values({2, 0.1}), [n = 0](const Block& block, int i) mutable {
    const double exact = Sine(2, 0.1, block.prediction_time[static_cast<std::size_t>(i)]);
    const double noise = 0.01 * std::sin(17.0 * ++n);
    return block.channel == "y" ? kStep * std::round((exact + noise) / kStep) - exact : 0;
  });
  const SensorEffects problem(std::move(inner));
  const Parameter& rounding = problem.parameters()[kOfY + kQuantisation];
  ASSERT_EQ(rounding.probes.size(), 1U);
  EXPECT_NEAR(rounding.probes[0], kStep, 1e-12);
  EXPECT_EQ(rounding.null_step, rounding.probes[0]);
  EXPECT_TRUE(problem.parameters()[kOfZ + kQuantisation].probes.empty());

  // The rounded prediction explains the quantised data better than the smooth one.
  const auto sum_of_squares = [&](double step) {
    Vector p = RestPoint(problem);
    p.head(2) << 2, 0.1;
    p[kOfY + kQuantisation] = step;
    const Prediction prediction = PredictAt(problem, p);
    const Block& block = problem.layout()[0];
    double sum = 0;
    for (int i = 0; i < kSamples; ++i)
      sum += std::pow(prediction.values(0)[i] - block.measured[static_cast<std::size_t>(i)], 2);
    return sum;
  };
  EXPECT_LT(sum_of_squares(rounding.probes[0]), 0.7 * sum_of_squares(0));
}

}  // namespace
}  // namespace sinew
