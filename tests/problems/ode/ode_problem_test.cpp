#include "problems/ode/ode_problem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "base/constants.h"
#include "base/random.h"
#include "identify/identification/identification.h"
#include "problems/own_model.h"
#include "tests/identify/support/error_of.h"
#include "tests/problems/support/jacobian_check.h"
#include "tests/problems/support/spring.h"

namespace sinew {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// One trial: input u(t) = t every 0.5 s, level every 0.1 s from 0.2 s.
Dataset RampData() {
  Dataset data;
  Trial& trial = data.trials["ramp"];
  trial.grids["in"].time = {0, 0.5, 1, 1.5, 2};
  trial.grids["in"].channels["u"] = {"V", ChannelKind::kInput, std::nullopt, {0, 0.5, 1, 1.5, 2}};
  Grid& grid = trial.grids["out"];
  std::vector<double> level;
  for (int i = 2; i <= 20; ++i) {
    grid.time.push_back(0.1 * i);
    level.push_back(1 + 0.1 * i);
  }
  grid.channels["level"] = {"m", ChannelKind::kMeasured, std::nullopt, level};
  return data;
}

/// level' = gain u - rate level. Tests spoil it.
class Lag final : public OdeProblem<Lag, 1> {
 public:
  explicit Lag(const Dataset& data) : OdeProblem(data) {
    rate_ = parameter("rate", "1/s").bounds(0.1, 10).start(1.3);
    gain_ = parameter("gain", "m/s/V").bounds(0, 10).start(2);
    u_ = input("u", "V");
    observe("level", state(0));
  }
  template <class T>
  void derivative(const Values<T>& p, double t, const State<T>& x, State<T>& dx) const {
    dx[0] = p[gain_] * p.input(u_, t) - p[rate_] * x[0];
    if (throws && t > 1) throw std::runtime_error("table ends at 1 s");
    if (undeclared) dx[0] += p[ParameterHandle{7}];
    if (not_finite && t > 1) dx[0] = dx[0] / 0.0;
  }

  using OdeProblem::set_most_steps;

  bool throws = false;
  bool undeclared = false;
  bool not_finite = false;

 private:
  ParameterHandle rate_, gain_;
  InputHandle u_;
};

Status PredictAt(const Problem& problem, const Vector& at, Prediction& prediction) {
  prediction.Poison();
  const std::vector<bool> all(problem.layout().size(), true);
  const auto workspace = problem.NewWorkspace();
  return problem.Predict({at, all, true, nullptr}, *workspace, prediction);
}

TEST(OdeProblem, ValuesAndSensitivitiesAreThoseOfTheAnalyticSolution) {
  const Lag lag(RampData());
  const Vector rest = RestPoint(lag);
  const double a = rest[0];
  const double b = rest[1];
  const double x0 = rest[2];
  Prediction prediction(lag.layout());
  ASSERT_EQ(ErrorOf(PredictAt(lag, rest, prediction)), "");
  EXPECT_EQ(lag.parameters()[2].name, "initial_level@ramp");
  EXPECT_EQ(lag.parameters()[2].kind, ParameterKind::kNuisance);
  EXPECT_EQ(lag.parameters()[2].trial, "ramp");
  EXPECT_EQ(x0, 1.2);
  constexpr double kAccuracy = 1e-8;  // ten steps of 1e-9
  for (Eigen::Index i = 0; i < prediction.values(0).size(); ++i) {
    // From t0 = 0.2 with u = t0 + s.
    const double t0 = 0.2;
    const double s = 0.1 * static_cast<double>(i);
    const double e = std::exp(-a * s);
    const double particular = (t0 + s) / a - 1 / (a * a);
    const double begin = t0 / a - 1 / (a * a);
    EXPECT_NEAR(prediction.values(0)[i], x0 * e + b * (particular - e * begin), kAccuracy);
    const double d_particular = -(t0 + s) / (a * a) + 2 / (a * a * a);
    const double d_begin = -t0 / (a * a) + 2 / (a * a * a);
    const auto slopes = prediction.derivatives(0).row(i);
    EXPECT_NEAR(slopes[0], -s * x0 * e + b * (d_particular - e * d_begin + s * e * begin), 10 * kAccuracy);
    EXPECT_NEAR(slopes[1], particular - e * begin, kAccuracy);
    EXPECT_NEAR(slopes[2], e, kAccuracy);
  }
}

TEST(OdeProblem, ABudgetOfStepsIsKept) {
  Lag lag(RampData());
  Prediction prediction(lag.layout());
  lag.set_most_steps(10);
  EXPECT_THAT(ErrorOf(PredictAt(lag, RestPoint(lag), prediction)), HasSubstr("10 steps until t = "));
  lag.set_most_steps(100000);
  EXPECT_EQ(ErrorOf(PredictAt(lag, RestPoint(lag), prediction)), "");
}

TEST(OdeProblem, DerivativesAgreeWithDifferencesAtRandomPoints) {
  const Spring spring(SpringData());
  Random random(3);
  ExpectJacobianAgrees(spring, random);
}

// The cost along a line, in steps so short that a smooth one has no second difference.
TEST(OdeProblem, TheCostIsAsSmoothAsStated) {
  Dataset data = SpringData();
  Random random(4);
  for (auto& [name, trial] : data.trials) {
    for (double& value : trial.grids["camera"].channels["position"].values) value += 0.01 * random.Normal();
  }
  const Spring spring(data);
  const FitSetup setup = MakeFitSetup(spring, {}).value();
  const LeastSquares fit(spring, setup);
  auto workspace = fit.NewWorkspace();
  constexpr double kStep = 1e-7;
  double worst = 0;
  for (int line = 0; line < 20; ++line) {
    Vector x = fit.Start();
    for (double& value : x) value = std::clamp(value + random.Uniform(-0.2, 0.2), 0.01, 0.99);
    double costs[3] = {NAN, NAN, NAN};
    for (int i = 0; i < 50; ++i) {
      x[line % 2] += kStep;  // stiffness or damping
      costs[0] = costs[1];
      costs[1] = costs[2];
      costs[2] = fit.Cost(x, workspace).value();
      if (i >= 2) worst = std::max(worst, std::abs(costs[2] - 2 * costs[1] + costs[0]) / costs[2]);
    }
  }
  std::printf("largest jump of the cost %.1e of it\n", worst);
  EXPECT_LT(worst, spring.cost_noise_level());
}

TEST(OdeProblem, InitialStatesAreColumnsOfTheirOwnTrialAlone) {
  const Spring spring(SpringData());
  for (const Block& block : spring.layout()) {
    int initial = 0;
    for (const int column : block.columns) {
      const Parameter& p = spring.parameters()[static_cast<std::size_t>(column)];
      if (p.trial.empty()) continue;
      EXPECT_EQ(p.trial, block.trial);
      ++initial;
    }
    EXPECT_EQ(initial, 2) << "position and velocity";
  }
  EXPECT_EQ(ErrorOf(CheckLayout(spring.layout(), static_cast<int>(spring.parameters().size()))), "");
}

TEST(OdeProblem, RolesUnitsNoiseAndGapsComeFromTheData) {
  Dataset data = SpringData();
  auto& camera = data.trials["one"].grids["camera"].channels["position"];
  camera.values[3] = kNaN;
  for (auto& [name, trial] : data.trials) trial.grids["camera"].channels["position"].sigma = 0.002;
  const Spring spring(data);
  const Block& block = spring.layout()[0];
  ASSERT_EQ(block.trial, "one");
  EXPECT_EQ(block.unit, "m");
  EXPECT_EQ(block.weight, 500);
  EXPECT_EQ(block.predictions(), 101);
  EXPECT_EQ(block.samples(), 100);
  EXPECT_EQ(block.sample[3], 4);
  int validate = 0;
  for (const Block& b : spring.layout()) validate += b.role == BlockRole::kValidate ? 1 : 0;
  EXPECT_EQ(validate, 2);
}

TEST(OdeProblem, EveryMeasuredChannelGetsSensorEffects) {
  const auto bound = BindModel<Spring>(SpringData(), true);
  ASSERT_TRUE(bound) << bound.error().message;
  std::vector<std::string> names;
  for (const Effect& effect : (*bound)->effects()) {
    if (effect.trial.empty()) names.push_back(effect.name);
  }
  EXPECT_THAT(names, testing::IsSupersetOf({"hardening", "position.time_offset", "power.gain"}));
}

TEST(OdeProblem, FindsTheParametersThatMadeTheData) {
  Dataset data = SpringData();
  const auto bound = BindModel<Spring>(data, false);
  ASSERT_TRUE(bound) << bound.error().message;
  FitRequest request;
  request.start = {{"stiffness", 45}, {"damping", 2}};
  const auto found = Identify(**bound, MakeFitSetup(**bound, request).value(), {});
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_TRUE(found->result.stop.converged());
  EXPECT_NEAR(found->parameters[0], 30, 1e-4);
  EXPECT_NEAR(found->parameters[1], 0.5, 1e-5);
}

TEST(OdeProblem, AModelThatThrowsOrIsNotFiniteIsNamedWithTrialTimeAndParameters) {
  Lag lag(RampData());
  Prediction prediction(lag.layout());
  const Vector rest = RestPoint(lag);
  const std::string with = "; with rate = 1.3, gain = 2, initial_level@ramp = 1.2";
  lag.throws = true;
  EXPECT_EQ(ErrorOf(PredictAt(lag, rest, prediction)),
            "trial 'ramp': the model threw: table ends at 1 s" + with);
  lag.throws = false;
  lag.not_finite = true;
  EXPECT_EQ(ErrorOf(PredictAt(lag, rest, prediction)),
            "trial 'ramp': the state is not finite after t = 1 s" + with);
  lag.not_finite = false;
  lag.undeclared = true;
  EXPECT_EQ(ErrorOf(PredictAt(lag, rest, prediction)),
            "trial 'ramp': the model threw: parameter 7 was never declared (3 are)" + with);
}

/// Declares what the test asks for.
class Told final : public OdeProblem<Told, 2> {
 public:
  Told(const Dataset& data, const std::function<void(Told&)>& declare) : OdeProblem(data) { declare(*this); }
  template <class T>
  void derivative(const Values<T>&, double, const State<T>&, State<T>& dx) const {
    dx = {T(0), T(0)};
  }
  using DeclaredProblem::constant;
  using DeclaredProblem::effect;
  using DeclaredProblem::input;
  using DeclaredProblem::parameter;
  using OdeProblem::initial;
  using OdeProblem::observe;
  using OdeProblem::set_accuracy;
  using OdeProblem::set_most_steps;
  using OdeProblem::state;
};

std::string ErrorOfDeclaring(const std::function<void(Told&)>& declare, const Dataset& data = RampData()) {
  const Told told(data, declare);
  const std::string error = ErrorOf(told.CheckDeclaration());
  Prediction prediction(told.layout());
  if (!error.empty() && !told.parameters().empty()) {
    // A fit without a check before it ends in the same error.
    EXPECT_EQ(ErrorOf(PredictAt(told, RestPoint(told), prediction)), error);
  }
  return error;
}

TEST(OdeProblem, WhatIsWrongWithADeclarationIsSaid) {
  EXPECT_EQ(ErrorOfDeclaring([](Told& m) { m.observe("levl", m.state(0)); }),
            "no trial measures the channel 'levl'; did you mean 'level'?");
  EXPECT_EQ(ErrorOfDeclaring([](Told& m) { m.observe("level", m.state(2)); }),
            "channel 'level' observes state 2, expected 0 .. 1");
  EXPECT_EQ(ErrorOfDeclaring([](Told& m) { m.observe("u", m.state(0)); }),
            "trial 'ramp': channel 'u' is an input, expected a measured one");
  EXPECT_EQ(ErrorOfDeclaring([](Told& m) { m.observe("level", m.state(0), "mm"); }),
            "trial 'ramp': channel 'level' is in 'm', expected 'mm'");
  EXPECT_EQ(ErrorOfDeclaring([](Told& m) { m.observe("level", m.state(0)); }),
            "state 1 has no initial value: expected initial(1, name, unit), or observe it");
  EXPECT_EQ(ErrorOfDeclaring([](Told& m) {
              m.observe("level", m.state(0));
              m.initial(1, 0.0);
              m.parameter("a", "1").start(3);
            }),
            "parameter 'a' has no bounds: expected .bounds(lower, upper)");
  EXPECT_EQ(ErrorOfDeclaring([](Told& m) { m.input("v", "V"); }),
            "trial 'ramp' has no channel 'v', which is an input of the model; did you mean 'u'?");
  EXPECT_EQ(ErrorOfDeclaring([](Told& m) { m.input("u", "A"); }),
            "trial 'ramp': input 'u' is in 'V', expected 'A'");
  EXPECT_THAT(ErrorOfDeclaring([](Told& m) { m.effect("overfow"); }), HasSubstr("was not declared before"));
  EXPECT_EQ(ErrorOfDeclaring([](Told& m) { m.constant("g"); }), "the data set has no constant 'g'");
  EXPECT_THAT(ErrorOfDeclaring([](Told& m) { m.set_accuracy(0.5); }), HasSubstr("expected 1e-14 .. 1e-2"));
  EXPECT_EQ(ErrorOfDeclaring([](Told& m) { m.set_most_steps(0); }),
            "0 steps of the integration: expected at least 1");
  EXPECT_EQ(ErrorOfDeclaring([](Told& m) { m.observe("level", m.state(0)); }, Dataset()),
            "the data set has no trial");
}

TEST(OdeProblem, AnInputThatEndsTooEarlyOrHasAGapIsSaid) {
  Dataset data = RampData();
  const auto declare = [](Told& m) {
    m.input("u", "V");
    m.observe("level", m.state(0));
    m.initial(1, 0.0);
  };
  EXPECT_EQ(ErrorOfDeclaring(declare, data), "");
  data.trials["ramp"].grids["in"].channels["u"].values[2] = kNaN;
  EXPECT_THAT(ErrorOfDeclaring(declare, data), HasSubstr("input 'u' has a gap at t = 1"));
  data = RampData();
  data.trials["ramp"].grids["in"].time = {0, 0.25, 0.5, 0.75, 1};
  EXPECT_EQ(ErrorOfDeclaring(declare, data),
            "trial 'ramp': an input is known from t = 0 to 1 s, expected 0.2 to 2 s");
}

}  // namespace
}  // namespace sinew
