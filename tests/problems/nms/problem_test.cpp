#include "problems/nms/problem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>

#include "identify/execution/evaluator.h"
#include "identify/fit_quality.h"
#include "identify/fit_setup.h"
#include "identify/least_squares.h"
#include "identify/solvers/solver.h"
#include "tests/problems/nms/ceinms_example.h"
#include "tests/problems/support/jacobian_check.h"

namespace sinew {
namespace {

constexpr const char* kYaml = R"(
nms:
  subject: subject.xml
  as_ceinms: true
  objective: thesis
  joints: [knee_angle_r, ankle_angle_r]
  parameters:
    filter_mean: {share: single, lower: -0.95, upper: -0.05}
    filter_spread: {share: single, lower: 0, upper: 0.81}
    shape: {share: single, lower: -2.999, upper: -0.001}
    tendon_slack_length: {share: single, lower: 0.85, upper: 1.15, relative: true}
    strength:
      groups:
        quadriceps: [rect_fem_r, vas_int_r, vas_lat_r, vas_med_r]
        hamstrings: [bifemlh_r, semimem_r]
        biceps_short: [bifemsh_r]
        gastrocnemii: [med_gas_r, lat_gas_r]
        soleus: [soleus_r]
        tibialis: [tib_ant_r]
      lower: 0.5
      upper: 2.5
)";

Result<std::unique_ptr<NmsProblem>> BindNms(const Dataset& data, const std::string& text = kYaml) {
  SINEW_ASSIGN(const YamlReader yaml, YamlReader::Parse(text, "nms.yaml"));
  SINEW_ASSIGN(const YamlReader section, yaml.At("nms"));
  SINEW_ASSIGN(NmsSettings settings, ReadNmsSettings(section, data.files));
  return NmsProblem::Make(data, std::move(settings));
}

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

class NmsProblemTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(ExamplePath("true.xml"))) GTEST_SKIP() << "needs the shared data";
  }
};

TEST_F(NmsProblemTest, JacobianAgreesWithDifferences) {
  const Dataset data = CeinmsExample("true.xml");
  for (const char* tendon : {"rigid", "equilibrium", "elastic"}) {
    for (const char* as_ceinms : {"true", "false"}) {
      std::string text = Replaced(kYaml, "as_ceinms: true",
                                  std::string("as_ceinms: ") + as_ceinms + "\n  tendon: " + tendon);
      if (std::string(as_ceinms) == "false")
        text = Replaced(text, "lower: -0.95, upper: -0.05", "lower: 0.005, upper: 0.1");
      const auto problem = BindNms(data, text);
      ASSERT_TRUE(problem) << problem.error().message;
      Random random(2);
      const JacobianCheck check = CheckJacobian(**problem, RandomInside(**problem, 0.3, random));
      // Steps of that check cross breaks of the curves; MuscleForceTest's are smaller.
      EXPECT_GT(check.compared, 0.35 * check.columns) << tendon << " " << as_ceinms;
      EXPECT_LT(check.worst, 1e-5) << tendon << " " << as_ceinms;
    }
  }
}

// CEINMS made the torques with true.xml. Its own calibration of these 50 parameters from start.xml ends at
// 2.5e-6 after 510,000 evaluations, and predicts the third trial to 0.08 and 0.04 N m.
TEST_F(NmsProblemTest, CalibratesWhatCeinmsMade) {
  const Dataset data = CeinmsExample("start.xml");
  const auto problem = BindNms(data);
  ASSERT_TRUE(problem) << problem.error().message;
  const auto truth = BindNms(CeinmsExample("true.xml"));
  ASSERT_TRUE(truth) << truth.error().message;
  const auto setup = MakeFitSetup(**problem, {});
  ASSERT_TRUE(setup) << setup.error().message;
  EXPECT_EQ(setup->free.size(), 50U);
  {
    const auto true_setup = MakeFitSetup(**truth, {});
    const LeastSquares at_truth(**truth, *true_setup);
    auto workspace = at_truth.NewWorkspace();
    EXPECT_LT(2 * *at_truth.Cost(at_truth.Start(), workspace), 1e-8) << "the truth";
  }
  const LeastSquares fit(**problem, *setup);
  const auto solver = MakeSolver("basin-hopping", {});
  Evaluator::Options options;
  options.target_cost = 1e-9;
  options.budget.max_evaluations = 20000;
  Evaluator evaluator(fit, options);
  const SolverResult result = (*solver)->Solve(evaluator, fit.Start());
  ASSERT_TRUE(result.stop.usable()) << result.stop.test;
  EXPECT_LT(2 * result.cost, 2.5e-6) << evaluator.evaluations() << " evaluations, " << result.stop.test;

  Prediction prediction((*problem)->layout());
  const Vector found = fit.Parameters(result.x);
  const std::vector<bool> all((*problem)->layout().size(), true);
  const auto scratch = (*problem)->NewWorkspace();
  ASSERT_TRUE((*problem)->Predict({found, all, false, nullptr}, *scratch, prediction));
  for (std::size_t b = 0; b < (*problem)->layout().size(); ++b) {
    const Block& block = (*problem)->layout()[b];
    if (block.role != BlockRole::kValidate) continue;
    double squares = 0;
    for (int i = 0; i < block.samples(); ++i) {
      const double error = prediction.values(static_cast<int>(b))[block.sample[static_cast<std::size_t>(i)]] -
                           block.measured[static_cast<std::size_t>(i)];
      squares += error * error / block.samples();
    }
    EXPECT_LT(std::sqrt(squares), block.channel == "knee_angle_r_moment" ? 0.08 : 0.04) << block.channel;
  }
}

TEST_F(NmsProblemTest, WrongDataGetOneSentence) {
  const auto failure = [](const std::function<void(Dataset&)>& spoil) {
    Dataset data = CeinmsExample("true.xml");
    spoil(data);
    const auto problem = BindNms(data);
    return problem ? std::string() : problem.error().message;
  };
  using testing::HasSubstr;
  EXPECT_THAT(failure([](Dataset& d) { d.trials["trial2"].grids.erase("lengths"); }),
              HasSubstr("trial 'trial2': has no grid 'lengths'"));
  EXPECT_THAT(failure([](Dataset& d) { d.trials["trial1"].grids["lengths"].channels.erase("soleus_r"); }),
              HasSubstr("no channel 'soleus_r'"));
  EXPECT_THAT(failure([](Dataset& d) {
                d.trials["trial1"].grids["excitations"].channels["soleus_r"].values[7] = NAN;
              }),
              HasSubstr("has a gap at t ="));
  EXPECT_THAT(failure([](Dataset& d) { d.trials["trial1"].grids["lengths"].time[3] += 1e-3; }),
              HasSubstr("has other times than grid 'lengths'"));
  EXPECT_THAT(failure([](Dataset& d) {
                for (double& m : d.trials["trial1"].grids["moments"].channels["knee_angle_r_moment"].values)
                  m = 3;
              }),
              HasSubstr("does not change"));
  EXPECT_THAT(failure([](Dataset& d) { d.trials["trial1"].grids.erase("moments"); }),
              HasSubstr("no measured moment"));
  EXPECT_EQ(failure([](Dataset& d) { d.trials.clear(); }), "holds no trial");
  EXPECT_THAT(failure([](Dataset& d) { d.files.clear(); }), HasSubstr("holds no file 'subject.xml'"));
  Dataset loud = CeinmsExample("true.xml");
  loud.trials["trial1"].grids["excitations"].channels["soleus_r"].values[7] = 1.4;
  const auto problem = BindNms(loud);
  ASSERT_TRUE(problem);
  EXPECT_THAT((*problem)->data().notes, testing::ElementsAre(HasSubstr("outside of 0..1")));
}

TEST_F(NmsProblemTest, WrongSettingsGetOneSentenceWithItsLine) {
  const Dataset data = CeinmsExample("true.xml");
  const auto failure = [&](const std::string& from, const std::string& to) {
    const auto problem = BindNms(data, Replaced(kYaml, from, to));
    return problem ? std::string() : problem.error().message;
  };
  using testing::HasSubstr;
  EXPECT_THAT(failure("as_ceinms: true", "as_ceinms: maybe"), HasSubstr("nms.yaml:4: as_ceinms: 'maybe'"));
  EXPECT_THAT(failure("[knee_angle_r,", "[knie_angle_r,"), HasSubstr("no joint coordinate 'knie_angle_r'"));
  EXPECT_THAT(failure("soleus: [soleus_r]", "soleus: [soleus_l]"), HasSubstr("the muscle 'soleus_l'"));
  EXPECT_THAT(failure("soleus: [soleus_r]", "soleus: [soleus_r, tib_ant_r]"),
              HasSubstr("two groups of strength"));
  EXPECT_THAT(failure("shape: {", "shap: {"), HasSubstr("shap"));
  EXPECT_THAT(failure("  joints: [", "  fibre_range: {lower: 2}\n  joints: ["),
              HasSubstr("nms.yaml:6: fibre_range: lower 2 is not below upper 1.5"));
  EXPECT_THAT(failure("  parameters:", "  steps: [{parameters: [shap]}]\n  parameters:"),
              HasSubstr("nms.yaml:7: steps: 'shap' is no parameter that is fitted; did you mean 'shape'?"));
  EXPECT_THAT(failure("  parameters:", "  steps: [{parameters: [shape], joints: []}]\n  parameters:"),
              HasSubstr("steps: joints: expected at least one"));
  EXPECT_THAT(failure("lower: -2.999", "lower: 2.999"), HasSubstr("is not below upper"));
}

// A start from which the calibration shortens fibres: the range holds them, at a price.
TEST_F(NmsProblemTest, FibresStayInTheirRange) {
  const Dataset data = CeinmsExample("start.xml");
  const auto fit = [&](const std::string& range, const char* solver) {
    const auto problem = BindNms(data, Replaced(kYaml, "  joints:", range + "  joints:"));
    EXPECT_TRUE(problem) << problem.error().message;
    const FitSetup setup = *MakeFitSetup(**problem, {});
    const LeastSquares squares(**problem, setup);
    Evaluator::Options options;
    options.budget.max_evaluations = 300;
    Evaluator evaluator(squares, options);
    const SolverResult result = (*MakeSolver(solver, {}))->Solve(evaluator, squares.Start());
    EXPECT_TRUE(result.stop.usable()) << result.stop.test;
    const Vector parameters = squares.Parameters(result.x);
    double least = 1;
    double most = 1;
    for (std::size_t t = 0; t < (*problem)->data().trials.size(); ++t) {
      if ((*problem)->data().trials[t].name == "trial3") continue;
      std::vector<MuscleTrace<double>> muscles;
      EXPECT_TRUE((*problem)->MusclesAt(parameters, t, muscles));
      const NmsParts parts = (*problem)->PartsAt(parameters, t);
      for (std::size_t m = 0; m < muscles.size(); ++m) {
        for (const double length : muscles[m].fibre_length) {
          least = std::min(least, length / parts.slots[m][kOptimalLength]);
          most = std::max(most, length / parts.slots[m][kOptimalLength]);
        }
      }
    }
    return std::tuple(least, most, (*problem)->WarningsAt(parameters));
  };
  const auto [least, most, remarks] = fit("", "lm");
  ASSERT_LT(least, 0.62);
  ASSERT_GT(most, 1.1);
  const std::string range = "  fibre_range: {lower: 0.65, upper: 1.1, tolerance: 0.02";
  const auto [drawn_least, drawn_most, drawn_remarks] = fit(range + "}\n", "lm");
  EXPECT_GT(drawn_least, least + 0.5 * (0.65 - least));
  EXPECT_LT(drawn_most, most - 0.5 * (most - 1.1));
  const auto [kept_least, kept_most, kept_remarks] = fit(range + ", as: constraint}\n", "ipopt");
  EXPECT_GE(kept_least, 0.65);
  EXPECT_LE(kept_most, 1.1);
  EXPECT_THAT(kept_remarks, testing::IsEmpty());
}

TEST_F(NmsProblemTest, DerivativesOfFibreLengthsAgreeWithDifferences) {
  const Dataset data = CeinmsExample("true.xml");
  for (const char* tendon : {"rigid", "elastic"}) {
    std::string text = Replaced(kYaml, "as_ceinms: true",
                                std::string("fibre_range: {}\n  as_ceinms: false\n  tendon: ") + tendon);
    text = Replaced(text, "lower: -0.95, upper: -0.05", "lower: 0.005, upper: 0.1");
    const auto problem = BindNms(data, text);
    ASSERT_TRUE(problem) << problem.error().message;
    ASSERT_EQ((*problem)->layout().size(), 3 * 2 + 2 * 11);
    Random random(2);
    const JacobianCheck check = CheckJacobian(**problem, RandomInside(**problem, 0.3, random));
    EXPECT_GT(check.compared, 0.35 * check.columns) << tendon;
    EXPECT_LT(check.worst, 1e-5) << tendon;
  }
}

TEST_F(NmsProblemTest, StepsFreeWhatTheyNameOfTheMusclesOfTheirJoints) {
  const Dataset data = CeinmsExample("true.xml");
  const auto problem = BindNms(data, Replaced(kYaml, "  parameters:", R"(  steps:
    - {joints: [ankle_angle_r], parameters: [shape, strength]}
    - {parameters: [tendon_slack_length]}
  parameters:)"));
  ASSERT_TRUE(problem) << problem.error().message;
  const auto& steps = (*problem)->steps();
  ASSERT_EQ(steps.size(), 2U);
  EXPECT_EQ(steps[0].name, "step 1 (ankle_angle_r: shape, strength)");
  EXPECT_EQ(steps[0].blocks.size(), 3U) << "the ankle in three trials";
  std::vector<std::string> names;
  for (const int p : steps[0].parameters)
    names.push_back((*problem)->parameters()[static_cast<std::size_t>(p)].name);
  EXPECT_THAT(names, testing::UnorderedElementsAre("med_gas_r.shape", "lat_gas_r.shape", "soleus_r.shape",
                                                   "tib_ant_r.shape", "gastrocnemii.strength",
                                                   "soleus.strength", "tibialis.strength"));
  EXPECT_EQ(steps[1].blocks.size(), 6U);
  EXPECT_EQ(steps[1].parameters.size(), 11U);
}

// Mean and distance of the poles are fitted; C1 and C2 are the published quantities; groups list their
// members.
TEST_F(NmsProblemTest, DerivesTheFiltersCoefficients) {
  const auto problem = BindNms(CeinmsExample("true.xml"));
  ASSERT_TRUE(problem);
  const auto setup = MakeFitSetup(**problem, {});
  const Subject& subject = (*problem)->settings().subject;
  const auto derived = (*problem)->DerivedQuantities();
  EXPECT_EQ(derived.size(), 2 * (*problem)->data().muscles.size());
  for (const DerivedQuantity& quantity : derived) {
    const auto dot = quantity.name.rfind('.');
    const SubjectMuscle& muscle = *subject.Find(quantity.name.substr(0, dot));
    const double expected =
        quantity.name.substr(dot) == ".C1" ? std::max(muscle.c1, muscle.c2) : std::min(muscle.c1, muscle.c2);
    EXPECT_NEAR(quantity.value(setup->rest), expected, 1e-12) << quantity.name;
    EXPECT_EQ(quantity.parameters.size(), 2U);
  }
  std::string text = Replaced(kYaml, "filter_mean: {share: single,",
                              "filter_mean: {groups: {calf: [med_gas_r, lat_gas_r, soleus_r]},");
  text = Replaced(text, "    filter_spread: {share: single, lower: 0, upper: 0.81}\n", "");
  const auto grouped = BindNms(CeinmsExample("start.xml"), text);
  ASSERT_TRUE(grouped) << grouped.error().message;
  const auto of_group = (*grouped)->DerivedQuantities();
  ASSERT_EQ(of_group.size(), 2U) << "the three muscles have the same distance at the start";
  EXPECT_EQ(of_group[0].name, "calf.C1");
  const auto shared = FindParameter((*grouped)->parameters(), "gastrocnemii.strength");
  EXPECT_THAT((*grouped)->parameters()[static_cast<std::size_t>(*shared)].shared_by,
              testing::ElementsAre("med_gas_r", "lat_gas_r"));
}

TEST_F(NmsProblemTest, CeinmsFIsTwiceTheCostOfItsObjective) {
  for (const std::string objective : {"thesis", "noise"}) {
    const auto problem =
        BindNms(CeinmsExample("start.xml"), Replaced(kYaml, "objective: thesis", "objective: " + objective));
    ASSERT_TRUE(problem) << problem.error().message;
    const auto as_ceinms = BindNms(CeinmsExample("start.xml"));
    const auto setup = MakeFitSetup(**as_ceinms, {});
    const LeastSquares fit(**as_ceinms, *setup);
    auto workspace = fit.NewWorkspace();
    const double cost = *fit.Cost(fit.Start(), workspace);
    const auto predicted = PredictAll(**problem, setup->rest);
    ASSERT_TRUE(predicted);
    const auto figures = (*problem)->FiguresOfMerit(setup->rest, predicted->values);
    ASSERT_EQ(figures.size(), 1U);
    EXPECT_NEAR(figures[0].value / (2 * cost), 1, 1e-12) << objective;
  }
}

// Parameters of the subject, through its own names and back.
TEST_F(NmsProblemTest, SubjectAtTheStartIsTheSubject) {
  const auto problem = BindNms(CeinmsExample("true.xml"));
  ASSERT_TRUE(problem);
  const auto setup = MakeFitSetup(**problem, {});
  const Subject subject = (*problem)->SubjectAt(setup->rest);
  const NmsSettings again =
      *ReadNmsSettings(*YamlReader::Parse(kYaml, "nms.yaml")->At("nms"), CeinmsExample("true.xml").files);
  for (const SubjectMuscle& muscle : subject.muscles) {
    const SubjectMuscle& old = *again.subject.Find(muscle.name);
    EXPECT_NEAR(std::max(muscle.c1, muscle.c2), std::max(old.c1, old.c2), 1e-12) << muscle.name;
    EXPECT_NEAR(std::min(muscle.c1, muscle.c2), std::min(old.c1, old.c2), 1e-12) << muscle.name;
    EXPECT_NEAR(muscle.tendon_slack_length, old.tendon_slack_length, 1e-15);
  }
}

}  // namespace
}  // namespace sinew
