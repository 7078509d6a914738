// Sensors in several trials: effects of one trial alone, and the port for discrepancy terms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "base/random.h"
#include "identify/check_problem.h"
#include "identify/fit_setup.h"
#include "identify/observation/sensor_effects.h"
#include "tests/identify/support/error_of.h"
#include "tests/identify/support/toy_problem.h"

namespace sinew {
namespace {

using toy::MakeBlock;
using toy::MakeParameter;
using toy::ToyProblem;
using toy::Values;

constexpr int kTrialSamples = 101;
constexpr double kTrialDuration = 2;

// A toy with signals and a port of its own.
class SignalProblem final : public Problem {
 public:
  using Signals = std::function<std::vector<Signal>(const Block&)>;
  SignalProblem(ToyProblem inner, Signals signals, std::vector<DiscrepancyTerm> terms = {})
      : inner_(std::move(inner)), signals_(std::move(signals)) {
    ports_.push_back({"torque", "1", "an unknown torque", std::move(terms)});
  }
  [[nodiscard]] const std::vector<Parameter>& parameters() const override { return inner_.parameters(); }
  [[nodiscard]] const Layout& layout() const override { return inner_.layout(); }
  [[nodiscard]] const std::vector<DiscrepancyPort>& ports() const override { return ports_; }
  Status Predict(const Query& query, Workspace& workspace, Prediction& prediction) const override {
    asked_ = query.differentiate != nullptr ? *query.differentiate : std::vector<bool>();
    return inner_.Predict(query, workspace, prediction);
  }
  [[nodiscard]] std::vector<Signal> ResidualCovariates(int block) const override {
    return signals_(inner_.layout()[static_cast<std::size_t>(block)]);
  }
  [[nodiscard]] const std::vector<bool>& asked() const { return asked_; }

 private:
  ToyProblem inner_;
  Signals signals_;
  std::vector<DiscrepancyPort> ports_;
  mutable std::vector<bool> asked_;
};

double SpeedAt(const Block& block, double t) {
  return (block.trial == "two" ? 2 : 1) * std::cos(3 * t);
}

// y in the trials one and two (fitted) and check (held out), with signals speed (all), y, and load (of one
// alone). Every fifth prediction time is not measured, nor are the outer ten: a margin.
std::unique_ptr<SignalProblem> ThreeTrials() {
  Layout layout;
  for (const std::string trial : {"one", "two", "check"}) {
    Block block = MakeBlock(trial, "y", kTrialSamples, kTrialDuration,
                            trial == "check" ? BlockRole::kValidate : BlockRole::kTrain);
    block.unit = "rad";
    block.sample.clear();
    block.measured.clear();
    for (int i = 10; i < kTrialSamples - 10; ++i) {
      if (i % 5 == 0) continue;
      block.sample.push_back(i);
      block.measured.push_back(0);
    }
    layout.push_back(block);
  }
  ToyProblem toy({MakeParameter("amplitude", 0.5, 4, 1), MakeParameter("phase", -1, 1, 0)}, layout,
                 [](const Block& block, double t, const Vector& p, Vector* gradient) -> Result<double> {
                   const double rate = block.trial == "two" ? 5 : 4;
                   if (gradient != nullptr)
                     *gradient << std::sin(rate * t + p[1]), p[0] * std::cos(rate * t + p[1]);
                   return p[0] * std::sin(rate * t + p[1]);
                 });
  Random random(1);
  toy.Measure(Values({2, 0.2}), [&](const Block&, int) { return 0.01 * random.Normal(); });
  return std::make_unique<SignalProblem>(std::move(toy), [](const Block& block) {
    Problem::Signal speed{"speed", "rad/s", {}};
    for (const int i : block.sample)
      speed.values.push_back(SpeedAt(block, block.prediction_time[static_cast<std::size_t>(i)]));
    speed.values[3] = std::numeric_limits<double>::quiet_NaN();
    const auto n = block.measured.size();
    std::vector<Problem::Signal> signals{
        speed, {"still", "1", std::vector<double>(n, 2)}, {"y", "rad", block.measured}};
    if (block.trial == "one") signals.push_back({"load", "N", speed.values});
    return signals;
  });
}

Prediction PredictTrialsAt(const Problem& problem, const Vector& p,
                           const std::vector<bool>* differentiate = nullptr) {
  Prediction prediction(problem.layout());
  const auto workspace = problem.NewWorkspace();
  EXPECT_TRUE(problem.Predict({p, {true, true, true}, true, differentiate}, *workspace, prediction));
  return prediction;
}

int IndexOf(const Problem& problem, const std::string& name) {
  const auto found = FindParameter(problem.parameters(), name);
  EXPECT_TRUE(found) << name;
  return found.value_or(0);
}

Eigen::Index ColumnOf(const Problem& problem, int block, int parameter) {
  const auto& columns = problem.layout()[static_cast<std::size_t>(block)].columns;
  const auto found = std::find(columns.begin(), columns.end(), parameter);
  return found == columns.end() ? -1 : found - columns.begin();
}

// A point inside the box where no sample is rounded or clipped, not too far from rest.
Vector PointInside(const Problem& problem, Random& random) {
  Vector p = RestPoint(problem);
  for (std::size_t i = 0; i < problem.parameters().size(); ++i) {
    const Parameter& parameter = problem.parameters()[i];
    const bool clips = parameter.name == "y.saturation" || parameter.name == "y.quantisation";
    const double share = clips ? 0 : random.Uniform(0.05, 0.3);
    const bool up = parameter.null_value - parameter.lower < 1e-12 || random.Index(2) == 0;
    const double bound = up ? parameter.upper : parameter.lower;
    p[static_cast<Eigen::Index>(i)] += share * (bound - parameter.rest_value());
  }
  return p;
}

TEST(SensorTrials, EachFittedTrialHasItsOwnEffects) {
  const SensorEffects problem(ThreeTrials());
  const auto count = static_cast<int>(problem.parameters().size());
  EXPECT_EQ(ErrorOf(CheckParameters(problem.parameters())), "");
  EXPECT_EQ(ErrorOf(CheckLayout(problem.layout(), count)), "");
  std::vector<std::string> alone;
  for (const Effect& effect : problem.effects()) {
    if (effect.trial.empty()) continue;
    alone.push_back(effect.name);
    const Parameter& p = problem.parameters()[static_cast<std::size_t>(effect.parameters.at(0))];
    EXPECT_EQ(p.trial, effect.trial);
    EXPECT_EQ(p.effect, effect.name);
    EXPECT_NE(effect.description.find("in trial " + effect.trial), std::string::npos) << effect.description;
    for (int b = 0; b < 3; ++b) {
      EXPECT_EQ(ColumnOf(problem, b, effect.parameters[0]) >= 0,
                problem.layout()[static_cast<std::size_t>(b)].trial == effect.trial);
    }
  }
  EXPECT_EQ(alone,
            (std::vector<std::string>{"y.offset@one", "y.drift@one", "y.gain@one", "y.time_offset@one",
                                      "y.offset@two", "y.drift@two", "y.gain@two", "y.time_offset@two"}));
}

TEST(SensorTrials, AnEffectOfOneTrialChangesNoOther) {
  const SensorEffects problem(ThreeTrials());
  const Prediction at_rest = PredictTrialsAt(problem, RestPoint(problem));
  for (const auto& [kind, value] : {std::pair<std::string, double>{"offset", 0.3},
                                    {"drift", 0.2},
                                    {"gain", 1.4},
                                    {"time_offset", 0.03}}) {
    Vector one = RestPoint(problem);
    one[IndexOf(problem, "y." + kind + "@one")] = value;
    Vector shared = RestPoint(problem);
    shared[IndexOf(problem, "y." + kind)] = value;
    const Prediction alone = PredictTrialsAt(problem, one);
    const Prediction all = PredictTrialsAt(problem, shared);
    EXPECT_EQ(Vector(alone.values(0)), Vector(all.values(0))) << kind;
    EXPECT_NE(Vector(alone.values(0)), Vector(at_rest.values(0))) << kind;
    EXPECT_EQ(Vector(alone.values(1)), Vector(at_rest.values(1))) << kind;
    EXPECT_EQ(Vector(alone.values(2)), Vector(at_rest.values(2))) << kind;
    EXPECT_NE(Vector(all.values(2)), Vector(at_rest.values(2))) << kind;
  }
}

TEST(SensorTrials, ThePortComesAfterTheProblemsOwn) {
  const SensorEffects problem(ThreeTrials());
  ASSERT_EQ(problem.ports().size(), 2U);
  EXPECT_EQ(problem.ports()[0].name, "torque");
  const DiscrepancyPort& port = problem.ports()[1];
  EXPECT_EQ(port.name, "y");
  EXPECT_EQ(port.unit, "rad");
  EXPECT_EQ(port.meaning, "something adds to the reading");
  std::vector<std::string> names;
  for (const DiscrepancyTerm& term : port.terms) names.push_back(term.name);
  EXPECT_EQ(names, (std::vector<std::string>{"y(time)", "y(speed)", "y(y)"}))
      << "load is known in one trial only, still never changes";
  const DiscrepancyTerm& time = port.terms[0];
  ASSERT_EQ(time.knots.size(), 8U);
  EXPECT_EQ(time.signal_unit, "s");
  EXPECT_EQ(time.knots.front(), 0);
  const auto& block = problem.layout()[0];
  EXPECT_NEAR(time.knots.back(), block.prediction_time[89] - block.prediction_time[11], 1e-12);
  EXPECT_LT(port.terms[1].knots.front(), -1.9) << "the range over all trials, two is twice as fast";
  EXPECT_EQ(problem.parameters()[static_cast<std::size_t>(time.parameters[3])].name, "y(time)[3]");
  EXPECT_EQ(problem.parameters()[static_cast<std::size_t>(time.parameters[3])].effect, "y(time)");
  FitRequest request;
  request.release = {"y(speed)"};
  const auto setup = MakeFitSetup(problem, request);
  ASSERT_TRUE(setup) << setup.error().message;
  EXPECT_EQ(setup->free.size(), 10U);
}

TEST(SensorTrials, ThePortOfAReadingIsNamedApartFromAPortOrParameterOfTheModel) {
  // A torque sensor beside the model's own port "torque", and one of the very quantity "gain" that is fitted.
  const auto formula = [](const Block&, double t, const Vector& p, Vector* gradient) -> Result<double> {
    if (gradient != nullptr) *gradient << t, 1 - t, t;
    return p[0] * t + p[1] * (1 - t) + p[2] * t;
  };
  std::vector<Parameter> parameters{MakeParameter("gain", 0, 4, 1)};
  DiscrepancyTerm term{"torque(time)", "time", "s", {0, 1}, {1, 2}};
  for (const std::string name : {"torque(time)[0]", "torque(time)[1]"}) {
    parameters.push_back(MakeParameter(name, -1, 1, 0, ParameterKind::kEffect));
    parameters.back().effect = term.name;
  }
  ToyProblem toy(
      parameters,
      {MakeBlock("one", "torque", 50, 1), MakeBlock("one", "gain", 50, 1), MakeBlock("one", "y", 50, 1)},
      formula);
  toy.Measure(Values({2, 0, 0}), [](const Block&, int) { return 0.0; });
  const SensorEffects problem(std::make_unique<SignalProblem>(
      std::move(toy), [](const Block&) { return std::vector<Problem::Signal>(); },
      std::vector<DiscrepancyTerm>{term}));
  EXPECT_EQ(ErrorOf(CheckStructure(problem)), "");
  std::vector<std::string> names;
  for (const DiscrepancyPort& port : problem.ports()) {
    for (const DiscrepancyTerm& one : port.terms) names.push_back(one.name);
  }
  EXPECT_EQ(names, (std::vector<std::string>{"torque(time)", "torque_reading(time)", "gain_reading(time)",
                                             "y(time)"}));
  FitRequest request;
  request.release = {"torque_reading(time)"};
  const auto setup = MakeFitSetup(problem, request);
  ASSERT_TRUE(setup) << setup.error().message;
  EXPECT_EQ(setup->parameters[static_cast<std::size_t>(setup->free.back())].effect, "torque_reading(time)");
}

TEST(SensorTrials, ATermIsTheSameCurveOfItsSignalInEveryTrial) {
  // Weights that follow the knots make the curve the signal itself: exact at samples and half way between
  // neighbouring ones. Speed sample 3 is missing and bridged, within h^2 / 8 * 18 of a gap of 0.06 s.
  constexpr double kTolerance = 1e-2;
  constexpr double kRounding = 1e-12;
  const SensorEffects problem(ThreeTrials());
  const DiscrepancyTerm& term = problem.ports()[1].terms[1];
  Vector p = RestPoint(problem);
  const Prediction plain = PredictTrialsAt(problem, p);
  for (std::size_t k = 0; k < term.knots.size(); ++k) p[term.parameters[k]] = 0.1 * term.knots[k];
  const Prediction observed = PredictTrialsAt(problem, p);
  for (int b = 0; b < 3; ++b) {
    const Block& block = problem.layout()[static_cast<std::size_t>(b)];
    const Vector added = observed.values(b) - plain.values(b);
    for (std::size_t i = 0; i < block.sample.size(); ++i) {
      const int at = block.sample[i];
      const double speed = SpeedAt(block, block.prediction_time[static_cast<std::size_t>(at)]);
      EXPECT_NEAR(added[at], 0.1 * speed, i == 3 ? kTolerance : kRounding) << block.trial << " " << at;
    }
    EXPECT_NEAR(added[0], added[11], kRounding) << "constant before the first sample";
    EXPECT_NEAR(added[kTrialSamples - 1], added[89], kRounding) << "constant beyond the last sample";
    EXPECT_NEAR(added[50], 0.5 * (added[49] + added[51]), kRounding) << "straight between samples";
  }
}

TEST(SensorTrials, ATermOfTheReadingItselfFollowsThePrediction) {
  constexpr double kRounding = 1e-12;
  const SensorEffects problem(ThreeTrials());
  const DiscrepancyTerm& term = problem.ports()[1].terms[2];
  Vector p = RestPoint(problem);
  const Prediction plain = PredictTrialsAt(problem, p);  // of amplitude 1, well inside the measured 2
  for (std::size_t k = 0; k < term.knots.size(); ++k) p[term.parameters[k]] = 0.1 * term.knots[k];
  const Prediction observed = PredictTrialsAt(problem, p);
  for (int b = 0; b < 3; ++b) {
    EXPECT_LT((observed.values(b) - 1.1 * plain.values(b)).cwiseAbs().maxCoeff(), kRounding);
    EXPECT_LT(
        (observed.derivatives(b).leftCols(2) - 1.1 * plain.derivatives(b).leftCols(2)).cwiseAbs().maxCoeff(),
        kRounding);
  }
}

TEST(SensorTrials, JacobianAgreesWithDifferencesForAllEffectsAtOnce) {
  constexpr double kStep = 3e-6;
  // Central differences: kStep^2 times third derivatives of up to 1e3, eps / kStep = 1e-10; a sample within
  // kStep of a knot of y(y) has a kink there, which this seed does not meet.
  constexpr double kTolerance = 1e-7;
  const SensorEffects problem(ThreeTrials());
  const auto count = static_cast<int>(problem.parameters().size());
  Random random(3);
  for (int round = 0; round < 10; ++round) {
    const Vector p = PointInside(problem, random);
    const Prediction at = PredictTrialsAt(problem, p);
    for (int k = 0; k < count; ++k) {
      const std::string& name = problem.parameters()[static_cast<std::size_t>(k)].name;
      if (name == "y.saturation" || name == "y.quantisation") continue;  // at their null, a bound
      const Prediction right = PredictTrialsAt(problem, p + kStep * Vector::Unit(count, k));
      const Prediction left = PredictTrialsAt(problem, p - kStep * Vector::Unit(count, k));
      for (int b = 0; b < 3; ++b) {
        const Vector difference = (right.values(b) - left.values(b)) / (2 * kStep);
        const Eigen::Index column = ColumnOf(problem, b, k);
        if (column < 0) {
          EXPECT_EQ(difference.norm(), 0) << name;
          continue;
        }
        EXPECT_LT((at.derivatives(b).col(column) - difference).norm(), kTolerance * (1 + difference.norm()))
            << "block " << b << ", " << name;
      }
    }
  }
}

TEST(SensorTrials, ColumnsAreTheSameWhicheverAreWanted) {
  constexpr double kUntouched = -123;
  auto inner = ThreeTrials();
  const SignalProblem& asked = *inner;
  const SensorEffects problem(std::move(inner));
  Random random(4);
  for (int round = 0; round < 100; ++round) {
    Vector p = PointInside(problem, random);
    if (round % 4 == 0) p = RestPoint(problem);
    if (round % 3 == 0) p[IndexOf(problem, "y.saturation")] = 0.6;
    if (round % 5 == 0) p[IndexOf(problem, "y.quantisation")] = 0.1;
    const Prediction full = PredictTrialsAt(problem, p);
    std::vector<bool> wanted(problem.parameters().size());
    for (std::size_t i = 0; i < wanted.size(); ++i) wanted[i] = random.Index(round % 2 == 0 ? 2 : 20) == 0;
    Prediction some(problem.layout());
    for (int b = 0; b < 3; ++b) some.derivatives(b).setConstant(kUntouched);
    const auto workspace = problem.NewWorkspace();
    ASSERT_TRUE(problem.Predict({p, {true, true, true}, true, &wanted}, *workspace, some));
    EXPECT_EQ(asked.asked(), std::vector<bool>(wanted.begin(), wanted.begin() + 2));
    for (int b = 0; b < 3; ++b) {
      EXPECT_EQ(Vector(some.values(b)), Vector(full.values(b)));
      const auto& columns = problem.layout()[static_cast<std::size_t>(b)].columns;
      for (std::size_t c = 0; c < columns.size(); ++c) {
        const auto at = static_cast<Eigen::Index>(c);
        const Vector column = some.derivatives(b).col(at);
        if (wanted[static_cast<std::size_t>(columns[c])]) {
          EXPECT_EQ(column, Vector(full.derivatives(b).col(at)));
        } else {
          EXPECT_EQ(column, Vector::Constant(kTrialSamples, kUntouched).eval());
        }
      }
    }
  }
}

}  // namespace
}  // namespace sinew
