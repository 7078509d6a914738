// What the engine relies on, checked for every problem of the registry, bare and seen through its sensors.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <thread>
#include <utility>

#include "base/random.h"
#include "identify/fit_setup.h"
#include "identify/least_squares.h"
#include "problems/registry.h"
#include "tests/problems/support/jacobian_check.h"
#include "tests/problems/support/spring.h"

namespace sinew {
namespace {

// How to ask each problem for data that its fitted model makes itself, and the truth in them.
struct Exact {
  std::map<std::string, double> experiment;
  std::map<std::string, double> truth;
  /// The problem fits states of its own: the truth is found to the precision of that search, derivatives are
  /// those of Kaufman, which differences confirm only where nothing is left (free_body_problem_test).
  bool fits_states = false;
  /// Share of the columns that must be smooth enough for differences.
  double least_compared = 0.9;
};
const std::map<std::string, Exact> kExact{
    {"ankle_on_dynamometer",
     {{{"exact", 1}, {"speeds", 1}, {"duration", 1}, {"rate", 100}, {"passive", 0}, {"isometric", 0}},
      {{"attachment_inertia", 0.07},
       {"attachment_gravity", 3.1},
       {"attachment_gravity_angle", 0.2},
       {"attachment_friction", 0.3},
       {"sole_stiffness", 7e6},
       {"sole_friction", 0.25},
       {"strap_stiffness", 8e3},
       {"strap_exponent", 60},
       {"strap_pretension", 35},
       {"passive_stiffness", 14},
       {"passive_exponent", 4.5},
       {"passive_linear_stiffness", 4},
       {"passive_damping", 0.5},
       {"shape", -0.9},
       {"filter_time", 0.03},
       {"delay", 0.05},
       {"strength.triceps", 1.1},
       {"strength.dorsiflexors", 0.9},
       {"tendon_slack_length.triceps", 1.005},
       {"tendon_slack_length.dorsiflexors", 0.995}},
      false,
      // The sole touches and lets go strip by strip, and excitations have corners at their samples.
      0.5}},
    {"contact",
     {{{"encoders", 1}, {"fine", 0}, {"train", 2}, {"validate", 1}},
      {{"stiffness", 7.5e5},
       {"dissipation", 33},
       {"static_friction", 0.95},
       {"dynamic_friction", 0.55},
       {"viscous_friction", 0.45}},
      false,
      // A sole that gives way feels a spring that touches, or a slip that turns round, at all later instants.
      0.8}},
    {"drive",
     {{{"exact", 1},
       {"speed", 1},
       {"train", 2},
       {"validate", 1},
       {"duration", 2},
       {"warming", 20},
       {"session", 5}},
      {{"inertia", 0.034}, {"viscous_friction", 0.061}, {"gravity_torque", 0.52}}}},
    {"drive_cascade",
     {{{"exact", 1},
       {"speed", 1},
       {"train", 1},
       {"validate", 1},
       {"duration", 2},
       {"cascade", 2},
       {"disturbance", 0.1},
       {"motor_off", 0.5}},
      {{"inertia", 0.034}, {"viscous_friction", 0.061}, {"gravity_torque", 0.52}}}},
    {"emg_shape",
     {{{"exact", 1}, {"speeds", 3}, {"muscles", 2}, {"moments", 0}, {"train", 2}, {"validate", 1}},
      {{"lead", 0.12}, {"lat_gas_r.amplitude_exponent", 0.6}, {"med_gas_r.amplitude_exponent", -0.3}}}},
    {"free_body",
     {{{"exact", 1}, {"train", 1}, {"validate", 1}, {"horizon", 0.1}},
      {{"stiffness", 3e5}, {"dissipation", 1.7}, {"friction", 0.23}},
      true}},
    {"nms",
     {{{"exact", 1}, {"cycles", 1}, {"train", 2}, {"validate", 1}},
      {{"triceps.strength", 0.83},
       {"peronei.strength", 1.15},
       {"dorsiflexors.strength", 0.94},
       {"plantarflexors.shape", -1.4},
       {"dorsiflexors.shape", -0.7},
       {"triceps.tendon_slack_length", 1.015},
       {"dorsiflexors.tendon_slack_length", 0.985}},
      false,
      // Excitations are cut off at 0, to which effects of all and of single trials lower them, and fibres
      // turn from stretch to shortening: columns with such kinks are not compared.
      0.8}},
    // A user's own model: what the two bases for them promise.
    {"spring", {{}, {{"stiffness", 30}, {"damping", 0.5}}}},
};

struct Case {
  const ProblemEntry* entry;
  bool with_sensor_effects;
  std::string variant = {};  // of the data; empty: the ordinary ones

  [[nodiscard]] std::string name() const { return entry->name + variant; }
};

void PrintTo(const Case& which, std::ostream* stream) {
  *stream << which.name() << (which.with_sensor_effects ? " with sensors" : "");
}

class ConformanceTest : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    ASSERT_EQ(kExact.count(GetParam().name()), 1U)
        << "tell this suite how to ask for exact data of " << Entry().name;
    if (Expected().fits_states && GetParam().with_sensor_effects)
      GTEST_SKIP() << "sensors are effects of the problem itself";
    problem_ = Bind(GetParam().with_sensor_effects);
    ASSERT_NE(problem_, nullptr);
  }

  static const ProblemEntry& Entry() { return *GetParam().entry; }
  static const Exact& Expected() { return kExact.at(GetParam().name()); }

  static std::unique_ptr<Problem> Bind(bool with_sensor_effects) {
    const Dataset& data = Data();
    const auto settings = YamlReader::Parse(data.files.at(Entry().name + ".yaml"), Entry().name + ".yaml");
    EXPECT_TRUE(settings) << settings.error().message;
    auto bound = Entry().bind(data, *settings, with_sensor_effects);
    EXPECT_TRUE(bound) << bound.error().message;
    return bound ? std::move(bound->problem) : nullptr;
  }

  [[nodiscard]] int ParameterCount() const { return static_cast<int>(problem_->parameters().size()); }
  [[nodiscard]] int BlockCount() const { return static_cast<int>(problem_->layout().size()); }
  [[nodiscard]] std::vector<bool> All() const { return std::vector<bool>(problem_->layout().size(), true); }

  [[nodiscard]] Prediction Predict(const Problem& problem, const Vector& parameters) const {
    Prediction prediction(problem.layout());
    const auto workspace = problem.NewWorkspace();
    const Status status = problem.Predict({parameters, All(), true, nullptr}, *workspace, prediction);
    EXPECT_TRUE(status) << status.error().message;
    return prediction;
  }

  /// Any point of the box: each parameter on a bound or, with equal chance, anywhere between.
  [[nodiscard]] Vector AnyPoint(Random& random) const {
    Vector point = RandomInside(*problem_, 0, random);
    for (int i = 0; i < ParameterCount(); ++i) {
      const Parameter& p = problem_->parameters()[static_cast<std::size_t>(i)];
      const auto draw = random.Index(4);
      if (draw == 0) point[i] = p.lower;
      if (draw == 1) point[i] = p.upper;
    }
    return point;
  }

  /// Any point that is not refused.
  Vector PredictablePoint(const Problem& problem, Random& random) const {
    const auto workspace = problem.NewWorkspace();
    Prediction prediction(problem.layout());
    for (int i = 0; i < 20; ++i) {
      const Vector point = RandomInside(problem, 0, random);
      if (problem.Predict({point, All(), false, nullptr}, *workspace, prediction)) return point;
    }
    ADD_FAILURE() << "20 points were refused";
    return RestPoint(problem);
  }

  [[nodiscard]] Vector Truth() const {
    Vector truth = RestPoint(*problem_);
    for (const auto& [name, value] : Expected().truth) {
      truth[FindParameter(problem_->parameters(), name).value()] = value;
    }
    return truth;
  }

  std::unique_ptr<Problem> problem_;

 private:
  static const Dataset& Data() {
    static std::map<std::string, Dataset> made;
    const auto found = made.find(GetParam().name());
    if (found != made.end()) return found->second;
    const Exact& exact = Expected();
    SynthesisRequest request;
    request.set = exact.experiment;
    request.set.insert(exact.truth.begin(), exact.truth.end());
    request.noise = 0;
    auto data = Entry().synthesize(request);
    EXPECT_TRUE(data) << data.error().message;
    return made[GetParam().name()] = data ? std::move(*data) : Dataset{};
  }
};

// A rounded prediction is a staircase: differences cannot confirm its derivatives, see SensorEffects.
bool IsRounding(const Parameter& p) {
  const std::string ending = ".quantisation";
  return p.name.size() > ending.size() &&
         p.name.compare(p.name.size() - ending.size(), ending.size(), ending) == 0;
}

void ExpectSameBits(const Prediction& a, const Prediction& b, int block) {
  const Vector values = a.values(block);
  EXPECT_EQ(values, Vector(b.values(block))) << "values of block " << block;
  const Matrix derivatives = a.derivatives(block);
  EXPECT_EQ(derivatives, Matrix(b.derivatives(block))) << "derivatives of block " << block;
}

TEST_P(ConformanceTest, ParametersLayoutAndEffectsAreValid) {
  const Status parameters = CheckParameters(problem_->parameters());
  EXPECT_TRUE(parameters) << parameters.error().message;
  const Status layout = CheckLayout(problem_->layout(), ParameterCount());
  EXPECT_TRUE(layout) << layout.error().message;
  for (const Parameter& p : problem_->parameters()) {
    EXPECT_FALSE(p.unit.empty()) << p.name;
    EXPECT_FALSE(p.meaning.empty()) << p.name;
  }
  for (const Effect& effect : problem_->effects()) {
    EXPECT_FALSE(effect.description.empty()) << effect.name;
    ASSERT_FALSE(effect.parameters.empty()) << effect.name;
    for (const int index : effect.parameters) {
      ASSERT_LT(index, ParameterCount());
      EXPECT_EQ(problem_->parameters()[static_cast<std::size_t>(index)].effect, effect.name);
    }
  }
  for (const DiscrepancyPort& port : problem_->ports()) {
    EXPECT_FALSE(port.meaning.empty()) << port.name;
    for (const DiscrepancyTerm& term : port.terms) {
      EXPECT_EQ(term.name, port.name + "(" + term.signal + ")");
      ASSERT_EQ(term.knots.size(), term.parameters.size()) << term.name;
      for (const int index : term.parameters) {
        const Parameter& p = problem_->parameters().at(static_cast<std::size_t>(index));
        EXPECT_EQ(p.effect, term.name);
        EXPECT_EQ(p.unit, port.unit);
        EXPECT_EQ(p.null_value, 0);
      }
    }
  }
  for (const Constraint& constraint : problem_->constraints()) {
    EXPECT_EQ(constraint.coefficients.size(), ParameterCount()) << constraint.name;
  }
}

TEST_P(ConformanceTest, JacobianAgreesWithDifferences) {
  constexpr double kTolerance = 1e-6;  // of differences, see CheckJacobian
  constexpr int kRounds = 5;           // ... and more, until every parameter has been compared
  constexpr int kMaxRounds = 20;
  if (Expected().fits_states) GTEST_SKIP() << "its derivatives have a test of their own";
  Random random(1);
  JacobianCheck total;
  std::set<int> never;
  for (int i = 0; i < ParameterCount(); ++i) {
    const Parameter& p = problem_->parameters()[static_cast<std::size_t>(i)];
    // Over a third of its samples have a kink in the bare problem; with sensors it is compared.
    const bool exempt = IsRounding(p) || (p.name == "emg_drift" && !GetParam().with_sensor_effects);
    if (!exempt) never.insert(i);
  }
  for (int round = 0; round < kRounds || (!never.empty() && round < kMaxRounds); ++round) {
    Vector point = RandomInside(*problem_, 0.02, random);
    for (int i = 0; i < ParameterCount(); ++i) {
      const Parameter& p = problem_->parameters()[static_cast<std::size_t>(i)];
      if (IsRounding(p)) point[i] = 0;
    }
    const JacobianCheck check = CheckJacobian(*problem_, point);
    total.columns += check.columns;
    total.compared += check.compared;
    total.worst = std::max(total.worst, check.worst);
    std::set<int> left;
    std::set_intersection(never.begin(), never.end(), check.never.begin(), check.never.end(),
                          std::inserter(left, left.end()));
    never = std::move(left);
  }
  RecordProperty("worst", fmt::format("{:.2e}", total.worst));
  std::printf("%d of %d columns compared, worst relative difference %.2e\n", total.compared, total.columns,
              total.worst);
  EXPECT_LT(total.worst, kTolerance);
  EXPECT_GE(total.compared, Expected().least_compared * total.columns);
  for (const int i : never)
    ADD_FAILURE() << problem_->parameters()[static_cast<std::size_t>(i)].name << " was never compared";
}

TEST_P(ConformanceTest, ResidualIsZeroAtTheTruth) {
  // Of the largest measured value: the same sums in the same order, or what a search leaves.
  const double tolerance = Expected().fits_states ? 1e-6 : 1e-9;
  const Prediction prediction = Predict(*problem_, Truth());
  double worst = 0;
  for (int b = 0; b < BlockCount(); ++b) {
    const Block& block = problem_->layout()[static_cast<std::size_t>(b)];
    double most = 0;
    double error = 0;
    for (std::size_t i = 0; i < block.measured.size(); ++i) {
      most = std::max(most, std::abs(block.measured[i]));
      error = std::max(error, std::abs(prediction.values(b)[block.sample[i]] - block.measured[i]));
    }
    if (block.role != BlockRole::kPredicted) {
      EXPECT_GT(most, 0) << block.channel;
    }
    if (most > 0) worst = std::max(worst, error / most);
  }
  std::printf("worst residual at the truth %.2e of the largest measured value\n", worst);
  EXPECT_LT(worst, tolerance);
}

TEST_P(ConformanceTest, NullEffectsChangeNothingToTheLastBit) {
  // With sensors a problem predicts a margin around its samples, so that the samples are what is compared.
  const auto bare = Bind(false);
  ASSERT_NE(bare, nullptr);
  ASSERT_EQ(bare->layout().size(), problem_->layout().size());
  const auto base = static_cast<Eigen::Index>(bare->parameters().size());
  Random random(2);
  for (int round = 0; round < 10; ++round) {
    Vector parameters = RestPoint(*problem_);
    const Vector inner = PredictablePoint(*bare, random);
    parameters.head(base) = inner;
    const Prediction expected = Predict(*bare, inner);
    const Prediction observed = Predict(*problem_, parameters);
    for (int b = 0; b < BlockCount(); ++b) {
      const Block& of_bare = bare->layout()[static_cast<std::size_t>(b)];
      const Block& block = problem_->layout()[static_cast<std::size_t>(b)];
      ASSERT_EQ(block.channel, of_bare.channel);
      ASSERT_EQ(block.measured, of_bare.measured);
      for (std::size_t i = 0; i < block.measured.size(); ++i) {
        ASSERT_EQ(observed.values(b)[block.sample[i]], expected.values(b)[of_bare.sample[i]]);
        for (std::size_t c = 0; c < of_bare.columns.size(); ++c) {
          ASSERT_EQ(observed.derivatives(b)(block.sample[i], static_cast<Eigen::Index>(c)),
                    expected.derivatives(b)(of_bare.sample[i], static_cast<Eigen::Index>(c)));
        }
      }
    }
  }
}

TEST_P(ConformanceTest, PredictionsAreFiniteOverTheWholeBox) {
  constexpr int kPoints = 100;
  Random random(3);
  Prediction prediction(problem_->layout());
  const auto workspace = problem_->NewWorkspace();
  for (int i = 0; i < kPoints; ++i) {
    const Vector parameters = AnyPoint(random);
    prediction.Poison();
    const Status status = problem_->Predict({parameters, All(), true, nullptr}, *workspace, prediction);
    if (!status) {  // a point may be refused, with a reason
      EXPECT_FALSE(status.error().message.empty());
      continue;
    }
    for (int b = 0; b < BlockCount(); ++b) {
      ASSERT_TRUE(prediction.values(b).allFinite()) << "block " << b << " at " << parameters.transpose();
      ASSERT_TRUE(prediction.derivatives(b).allFinite()) << "block " << b << " at " << parameters.transpose();
    }
  }
}

TEST_P(ConformanceTest, TheAnswerDoesNotDependOnWhatIsWanted) {
  constexpr double kUntouched = 0.123;
  Random random(4);
  const auto workspace = problem_->NewWorkspace();
  for (int round = 0; round < 30; ++round) {
    const Vector parameters = PredictablePoint(*problem_, random);
    const Prediction all = Predict(*problem_, parameters);
    std::vector<bool> wanted = All();
    for (std::size_t b = 0; b < wanted.size(); ++b) wanted[b] = random.Index(3) == 0;
    Prediction some(problem_->layout());
    for (int b = 0; b < BlockCount(); ++b) some.derivatives(b).setConstant(kUntouched);
    ASSERT_TRUE(problem_->Predict({parameters, wanted, true, nullptr}, *workspace, some));
    Prediction without_derivatives(problem_->layout());
    ASSERT_TRUE(problem_->Predict({parameters, wanted, false, nullptr}, *workspace, without_derivatives));
    for (int b = 0; b < BlockCount(); ++b) {
      if (wanted[static_cast<std::size_t>(b)]) {
        ExpectSameBits(some, all, b);
        EXPECT_EQ(Vector(without_derivatives.values(b)), Vector(all.values(b))) << "values of block " << b;
      } else {
        EXPECT_TRUE(some.values(b).array().isNaN().all()) << "block " << b << " was not wanted";
        EXPECT_TRUE((some.derivatives(b).array() == kUntouched).all()) << "block " << b << " was not wanted";
      }
    }
  }
}

TEST_P(ConformanceTest, ThreadsWithTheirOwnWorkspaceGetTheSameBits) {
  constexpr int kThreads = 4;
  constexpr int kPoints = 10;
  Random random(5);
  std::vector<Vector> points;
  std::vector<Prediction> expected;
  for (int i = 0; i < kPoints; ++i) {
    points.push_back(PredictablePoint(*problem_, random));
    expected.push_back(Predict(*problem_, points.back()));
  }
  std::vector<std::vector<Prediction>> found(
      kThreads, std::vector<Prediction>(kPoints, Prediction(problem_->layout())));
  std::vector<std::thread> threads;
  for (auto& predictions : found) {
    threads.emplace_back([&] {
      const auto workspace = problem_->NewWorkspace();
      for (int i = kPoints; i-- > 0;) {  // in another order: a workspace remembers nothing
        const auto at = static_cast<std::size_t>(i);
        static_cast<void>(problem_->Predict({points[at], All(), true, nullptr}, *workspace, predictions[at]));
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const auto& predictions : found) {
    for (std::size_t i = 0; i < kPoints; ++i) {
      for (int b = 0; b < BlockCount(); ++b) ExpectSameBits(predictions[i], expected[i], b);
    }
  }
}

TEST_P(ConformanceTest, SearchesStayWithinTheBounds) {
  const auto setup = MakeFitSetup(*problem_, {});
  ASSERT_TRUE(setup) << setup.error().message;
  const LeastSquares fit(*problem_, *setup);
  Random random(6);
  for (int round = 0; round < 200; ++round) {
    Vector x(fit.variables());
    for (double& value : x) value = random.Uniform(-0.5, 1.5);
    const Vector parameters = fit.Parameters(x);
    for (int i = 0; i < ParameterCount(); ++i) {
      const Parameter& p = problem_->parameters()[static_cast<std::size_t>(i)];
      ASSERT_GE(parameters[i], p.lower) << p.name;
      ASSERT_LE(parameters[i], p.upper) << p.name;
    }
  }
}

TEST_P(ConformanceTest, DescribesItselfWithoutFailure) {
  Hdf5Node details;
  const Status status = problem_->WriteDetails(Truth(), details);
  EXPECT_TRUE(status) << status.error().message;
  EXPECT_FALSE(problem_->objective().empty());
}

std::vector<Case> Cases() {
  std::vector<Case> cases;
  for (const ProblemEntry& entry : ProblemRegistry()) {
    cases.push_back({&entry, false});
    cases.push_back({&entry, true});
    if (entry.name != "drive") continue;
    cases.push_back({&entry, false, "_cascade"});
  }
  static const ProblemEntry kSpring = SpringEntry();
  cases.push_back({&kSpring, false});
  cases.push_back({&kSpring, true});
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Problems, ConformanceTest, testing::ValuesIn(Cases()), [](const auto& which) {
  return which.param.name() + (which.param.with_sensor_effects ? "_with_sensors" : "");
});

}  // namespace
}  // namespace sinew
