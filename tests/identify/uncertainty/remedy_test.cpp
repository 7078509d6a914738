#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/random.h"
#include "identify/uncertainty/uncertainty.h"
#include "tests/identify/support/toy_problem.h"

namespace sinew {
namespace {

using testing::ElementsAre;
using toy::MakeBlock;
using toy::MakeParameter;
using toy::ToyFit;
using toy::ToyProblem;
using toy::Values;

// A foot on level ground: the vertical force depends on the stiffness, the tangential one on friction as
// well, and the temperature of the plate on neither. Two frictions occur only as a product unless the speed
// is measured.
enum { kStiffness, kStatic, kViscous };

Result<double> Foot(const Block& block, double t, const Vector& p, Vector* gradient) {
  const double depth = std::sin(t);
  Vector unused = Vector::Zero(p.size());
  Vector& g = gradient != nullptr ? *gradient : unused;
  if (block.channel == "force_y") {
    g[kStiffness] = depth;
    return p[kStiffness] * depth;
  }
  if (block.channel == "force_x") {
    const double slip = std::cos(5 * t);
    g[kStiffness] = depth * (p[kStatic] + p[kViscous] * slip);
    g[kStatic] = p[kStiffness] * depth;
    g[kViscous] = p[kStiffness] * depth * slip;
    return p[kStiffness] * depth * (p[kStatic] + p[kViscous] * slip);
  }
  if (block.channel == "heat") {
    g[kStatic] = 1;
    g[kViscous] = 1;
    return p[kStatic] + p[kViscous];
  }
  return 20.0;  // temperature
}

ToyProblem FootProblem(Layout layout) {
  ToyProblem problem({MakeParameter("stiffness", 10, 1000, 300), MakeParameter("static_friction", 0, 15, 0.8),
                      MakeParameter("viscous_friction", 0, 15, 0.3)},
                     std::move(layout), Foot);
  Random random(17);
  problem.Measure(Values({300, 0.8, 0.3}), [&](const Block&, int) { return 3 * random.Normal(); });
  return problem;
}

const AdditionName kForceX{AdditionKind::kChannel, "force_x"};

Uncertainty Analyse(const ToyProblem& problem) {
  const ToyFit fit(problem);
  const Result<Uncertainty> answer = AnalyseUncertainty(fit.view, fit.view.Start(), {});
  EXPECT_TRUE(answer) << answer.error().message;
  return answer ? *answer : Uncertainty{};
}

TEST(Remedy, NamesTheChannelThatFixesEveryFriction) {
  const Uncertainty answer =
      Analyse(FootProblem({MakeBlock("stance", "force_y", 50, 1.5),
                           MakeBlock("stance", "force_x", 50, 1.5, BlockRole::kPredicted),
                           MakeBlock("stance", "temperature", 50, 1.5, BlockRole::kPredicted)}));
  EXPECT_EQ(answer.parameters[kStiffness].verdict, Verdict::kIdentifiable);
  EXPECT_EQ(answer.parameters[kStiffness].remedy.kind, RemedyKind::kNone);
  for (const int friction : {kStatic, kViscous}) {
    const ParameterVerdict& verdict = answer.parameters[static_cast<std::size_t>(friction)];
    EXPECT_EQ(verdict.verdict, Verdict::kNotIdentifiable);
    EXPECT_EQ(verdict.reason.kind, ReasonKind::kNoResponse);
    EXPECT_THAT(verdict.reason.channels, ElementsAre("force_y"));
    EXPECT_EQ(verdict.remedy.kind, RemedyKind::kAdditions);
    ASSERT_EQ(verdict.remedy.options.size(), 1U) << "the temperature is none";
    EXPECT_THAT(verdict.remedy.options[0].additions, ElementsAre(kForceX));
    EXPECT_GT(verdict.remedy.options[0].std_error, 0);
    EXPECT_LT(verdict.remedy.options[0].std_error, 0.1);
  }
}

TEST(Remedy, ErrorIsThatOfAFitWithTheAddition) {
  // The predicted standard error against that of a fit with the addition, with the stated noise.
  Block tangential = MakeBlock("stance", "force_x", 50, 1.5, BlockRole::kPredicted);
  tangential.sigma = 3;
  Block vertical = MakeBlock("stance", "force_y", 50, 1.5);
  vertical.sigma = 3;
  const Uncertainty before = Analyse(FootProblem({vertical, tangential}));
  tangential = MakeBlock("stance", "force_x", 50, 1.5);
  tangential.sigma = 3;
  const Uncertainty after = Analyse(FootProblem({vertical, tangential}));
  const Remedy& remedy = before.parameters[kViscous].remedy;
  ASSERT_EQ(remedy.options.size(), 1U);
  // The linearisation point differs by the noise.
  EXPECT_NEAR(remedy.options[0].std_error / after.parameters[kViscous].std_error, 1, 0.06);
}

TEST(Remedy, NamesAValidationTrial) {
  const Uncertainty answer =
      Analyse(FootProblem({MakeBlock("stance", "force_y", 50, 1.5),
                           MakeBlock("slide", "force_x", 50, 1.5, BlockRole::kValidate)}));
  const Remedy& remedy = answer.parameters[kStatic].remedy;
  EXPECT_EQ(remedy.kind, RemedyKind::kAdditions);
  ASSERT_FALSE(remedy.options.empty());
  EXPECT_THAT(remedy.options[0].additions, ElementsAre(AdditionName{AdditionKind::kTrial, "slide"}));
}

// A scale whose zero is not known: `level` acts on no fitted trial, only on the held-out trial "tare", whose
// own offset is fitted with it and does the same; on "ramp" it acts in proportion to time.
ToyProblem ScaleProblem(const std::vector<std::string>& held_out, BlockRole role = BlockRole::kValidate) {
  std::vector<Parameter> parameters{MakeParameter("gain", 0.1, 10, 1), MakeParameter("level", -50, 50, 1)};
  Layout layout{MakeBlock("load", "y", 50, 1)};
  for (const std::string& trial : held_out) {
    layout.push_back(MakeBlock(trial, "y", 50, 1, role));
    parameters.push_back(MakeParameter("offset@" + trial, -100, 100, 0, ParameterKind::kNuisance));
    parameters.back().trial = trial;
  }
  for (Block& block : layout) block.sigma = 0.1;
  const auto own = [held_out](const std::string& trial) {
    return static_cast<Eigen::Index>(2 +
                                     (std::find(held_out.begin(), held_out.end(), trial) - held_out.begin()));
  };
  ToyProblem problem(parameters, layout,
                     [own](const Block& block, double t, const Vector& p, Vector* gradient) {
                       const double by_level = block.trial == "load" ? 0 : block.trial == "ramp" ? t : 1;
                       double value = p[0] * t + p[1] * by_level;
                       if (gradient != nullptr) (*gradient)[0] = t;
                       if (gradient != nullptr) (*gradient)[1] = by_level;
                       if (block.trial == "load") return Result<double>(value);
                       if (gradient != nullptr) (*gradient)[own(block.trial)] = 1;
                       value += p[own(block.trial)];
                       return Result<double>(value);
                     });
  Vector truth = Vector::Zero(static_cast<Eigen::Index>(parameters.size()));
  truth.head(2) << 2, 3;
  Random random(17);
  problem.Measure(truth, [&](const Block&, int) { return 0.1 * random.Normal(); });
  return problem;
}

TEST(Remedy, ATrialWhoseOwnNuisanceFollowsTheParameterIsNone) {
  EXPECT_EQ(Analyse(ScaleProblem({"tare"})).parameters[1].remedy.kind, RemedyKind::kNoChannel)
      << "its offset would be fitted with it";
  const Remedy remedy = Analyse(ScaleProblem({"tare", "ramp"})).parameters[1].remedy;
  ASSERT_EQ(remedy.options.size(), 1U);
  EXPECT_THAT(remedy.options[0].additions, ElementsAre(AdditionName{AdditionKind::kTrial, "ramp"}));
}

TEST(Remedy, TheErrorIsThatOfAFitOfTheTrialWithItsNuisance) {
  const Uncertainty before = Analyse(ScaleProblem({"ramp"}));
  const Uncertainty after = Analyse(ScaleProblem({"ramp"}, BlockRole::kTrain));
  const Remedy& remedy = before.parameters[1].remedy;
  ASSERT_EQ(remedy.options.size(), 1U);
  EXPECT_NEAR(remedy.options[0].std_error / after.parameters[1].std_error, 1, 1e-6) << "the model is linear";
}

TEST(Remedy, NamesAPairWhenNoSingleChannelIsEnough) {
  // The heat determines the sum of both frictions; the weak tangential channel matters only for their
  // difference.
  const auto formula = [](const Block& block, double t, const Vector& p, Vector* gradient) -> Result<double> {
    Vector unused = Vector::Zero(3);
    Vector& g = gradient != nullptr ? *gradient : unused;
    if (block.channel == "sum") {
      g << 0, 1, 1;
      return p[1] + p[2];
    }
    if (block.channel == "difference") {
      g << 0, 1, -1;
      return p[1] - p[2];
    }
    g << t, 0, 0;
    return p[0] * t;
  };
  ToyProblem problem(
      {MakeParameter("stiffness", 10, 1000, 300), MakeParameter("left", 0, 15, 2),
       MakeParameter("right", 0, 15, 1)},
      {MakeBlock("stance", "force_y", 50, 1.5), MakeBlock("stance", "sum", 50, 1.5, BlockRole::kPredicted),
       MakeBlock("stance", "difference", 50, 1.5, BlockRole::kPredicted)},
      formula);
  Random random(17);
  problem.Measure(Values({300, 2, 1}), [&](const Block&, int) { return 3 * random.Normal(); });
  const Uncertainty answer = Analyse(problem);
  const Remedy& remedy = answer.parameters[1].remedy;
  EXPECT_EQ(remedy.kind, RemedyKind::kAdditions);
  ASSERT_FALSE(remedy.options.empty());
  EXPECT_THAT(remedy.options[0].additions, ElementsAre(AdditionName{AdditionKind::kChannel, "sum"},
                                                       AdditionName{AdditionKind::kChannel, "difference"}));
}

TEST(Remedy, ReportsWhenNoAdditionHelps) {
  const Uncertainty answer =
      Analyse(FootProblem({MakeBlock("stance", "force_y", 50, 1.5),
                           MakeBlock("stance", "temperature", 50, 1.5, BlockRole::kPredicted)}));
  EXPECT_EQ(answer.parameters[kStatic].remedy.kind, RemedyKind::kNoChannel);
  EXPECT_TRUE(answer.parameters[kStatic].remedy.options.empty());
}

TEST(Remedy, CorrelatedResidualsAreToBeExplainedFirst) {
  // A slow wave that no parameter can follow makes the robust error many times the plain one.
  ToyProblem problem({MakeParameter("level", 0, 20, 1)}, {MakeBlock("one", "height", 400, 1)},
                     [](const Block&, double, const Vector& p, Vector* gradient) -> Result<double> {
                       if (gradient != nullptr) (*gradient)[0] = 1;
                       return p[0];
                     });
  Random random(8);
  double last = 0;
  problem.Measure(Values({3}), [&](const Block&, int) { return last = 0.97 * last + 0.5 * random.Normal(); });
  const Uncertainty answer = Analyse(problem);
  const ParameterVerdict& level = answer.parameters[0];
  ASSERT_EQ(level.verdict, Verdict::kWeak);
  EXPECT_EQ(level.reason.kind, ReasonKind::kDependentResiduals);
  EXPECT_GT(level.reason.std_error, 2 * level.reason.std_error_without);
  EXPECT_EQ(level.remedy.kind, RemedyKind::kIndependentNoise);
  const Warning& note = answer.notes.back();
  EXPECT_EQ(note.kind, WarningKind::kDependentResiduals);
  EXPECT_THAT(note.names, ElementsAre("height"));
  ASSERT_EQ(note.numbers.size(), 2U);
  EXPECT_GT(note.numbers[0], 1.5) << "widened so many times";
  EXPECT_GT(note.numbers[1], 0.8) << "correlation of neighbours";
}

}  // namespace
}  // namespace sinew
