#include "identify/diagnosis/level_evidence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "identify/diagnosis/score/shortlist.h"
#include "identify/text/diagnosis_sentences.h"
#include "tests/identify/diagnosis/linear_laws.h"

namespace sinew {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

Diagnosis Examine(const LinearLaws::Truth& truth, int threads = 1, std::uint64_t seed = 5) {
  const LinearLaws problem(truth, seed);
  DiagnosisOptions options;
  options.threads = threads;
  auto diagnosis = Diagnose(problem, MakeFitSetup(problem, {}).value(), options);
  EXPECT_TRUE(diagnosis) << diagnosis.error().message;
  return diagnosis ? *diagnosis : Diagnosis{};
}

const LevelEvidence* Of(const Diagnosis& d, Level level) {
  for (const LevelEvidence& one : d.levels) {
    if (one.level == level) return &one;
  }
  return nullptr;
}

std::string LevelSentence(const Diagnosis& d) {
  for (const text::Sentence& sentence : text::Sentences(d)) {
    if (sentence.kind == text::SentenceKind::kLevel) return sentence.text;
  }
  return {};
}

TEST(LevelEvidence, TheLevelOfTheOnlyCauseIsBlamed) {
  LinearLaws::Truth truth;
  truth.effects = {{"step_size", 1}};
  truth.levels = {{"step", Level::kBoundary}, {"twin", Level::kBoundary}, {"quadratic", Level::kHuman}};
  const Diagnosis d = Examine(truth);
  ASSERT_EQ(d.causes.size(), 1U);
  EXPECT_EQ(d.causes[0].effect, "step");
  ASSERT_EQ(d.levels.size(), 3U);  // no effect of all trials is of a sensor
  const LevelEvidence& first = d.levels.front();
  EXPECT_EQ(first.level, Level::kBoundary);
  EXPECT_EQ(first.standing, LevelStanding::kBlamed);
  EXPECT_THAT(first.effects, ElementsAre("step"));
  EXPECT_EQ(first.parameters, 1);
  EXPECT_NEAR(first.delta_lr, d.causes[0].delta_lr, 1e-9 * first.delta_lr);
  EXPECT_NEAR(first.behind, 0, 1e-9);
  for (std::size_t i = 1; i < d.levels.size(); ++i) {
    const LevelEvidence& other = d.levels[i];
    EXPECT_EQ(other.standing, LevelStanding::kWorse);
    EXPECT_GT(other.behind, diagnosis::kSetWidth);
    // The same scale: likelihood ratio less 4 per parameter.
    EXPECT_NEAR(other.behind, first.delta_lr - other.delta_lr + 4 * (other.parameters - 1),
                1e-6 * first.delta_lr);
  }
  EXPECT_LE(d.levels[1].behind, d.levels[2].behind);
  EXPECT_THAT(LevelSentence(d), HasSubstr("Level: boundary. The best of another level: "));
}

TEST(LevelEvidence, AnAlternativeOfAnotherLevelIsPossible) {
  LinearLaws::Truth truth;
  truth.effects = {{"step_size", 0.05}};
  truth.levels = {{"step", Level::kBoundary}, {"twin", Level::kHuman}};
  const Diagnosis d = Examine(truth, 1, 3);
  ASSERT_EQ(d.verdict, DiagnosisVerdict::kAmbiguous);
  const LevelEvidence* human = Of(d, Level::kHuman);
  const LevelEvidence* boundary = Of(d, Level::kBoundary);
  ASSERT_TRUE(human != nullptr && boundary != nullptr);
  EXPECT_TRUE((human->standing == LevelStanding::kPossible) !=
              (boundary->standing == LevelStanding::kPossible));
  EXPECT_LT(std::abs(human->behind - boundary->behind), diagnosis::kSetWidth);
  EXPECT_THAT(LevelSentence(d), HasSubstr("these data do not tell them apart; "));
}

TEST(LevelEvidence, CausesOfTwoLevelsBlameBoth) {
  LinearLaws::Truth truth;
  truth.effects = {{"step_size", 1}, {"quadratic_size", 0.5}};
  truth.levels = {{"step", Level::kBoundary}, {"twin", Level::kBoundary}, {"quadratic", Level::kHuman}};
  const Diagnosis d = Examine(truth);
  ASSERT_EQ(d.causes.size(), 2U);
  for (const Level level : {Level::kBoundary, Level::kHuman}) {
    ASSERT_NE(Of(d, level), nullptr);
    EXPECT_EQ(Of(d, level)->standing, LevelStanding::kBlamed);
    EXPECT_GT(Of(d, level)->behind, diagnosis::kSetWidth);
    EXPECT_FALSE(Of(d, level)->suffices);
    for (const std::string& effect : Of(d, level)->effects) EXPECT_NE(effect, "drift");
  }
  EXPECT_EQ(Of(d, Level::kRobot)->standing, LevelStanding::kWorse);
  const std::string said = LevelSentence(d);
  EXPECT_THAT(said, HasSubstr("Levels: "));
  EXPECT_THAT(said, HasSubstr("No level suffices alone: "));

  Diagnosis close = d;
  for (LevelEvidence& one : close.levels) one.suffices = one.level == Level::kBoundary;
  EXPECT_THAT(LevelSentence(close), HasSubstr(". One level may be enough: "));
  EXPECT_THAT(LevelSentence(close), HasSubstr("[boundary]"));
  EXPECT_THAT(LevelSentence(close), Not(HasSubstr("[human]")));
}

TEST(LevelEvidence, AlternativesOfOneLevelMaySufficeTogether) {
  // The twin of the step is of the other cause's level; the noise does not let them be told apart.
  LinearLaws::Truth truth;
  truth.effects = {{"step_size", 1}, {"quadratic_size", 2}};
  truth.noise = 1;
  truth.levels = {{"step", Level::kBoundary}, {"twin", Level::kHuman}, {"quadratic", Level::kHuman}};
  const Diagnosis d = Examine(truth);
  ASSERT_EQ(d.causes.size(), 2U);
  const LevelEvidence* human = Of(d, Level::kHuman);
  ASSERT_NE(human, nullptr);
  EXPECT_TRUE(human->suffices) << human->behind;
  EXPECT_THAT(human->effects, testing::UnorderedElementsAre("quadratic", "twin"));
}

// A misfit that dominates the noise: likelihoods say little, left-out data decide.
TEST(LevelEvidence, ByCrossValidationLeftOutErrorsAreTold) {
  LinearLaws::Truth truth;
  truth.noise = 0.005;
  truth.effects = {{"step_size", 2}};
  truth.slow_error = 0.15;
  truth.levels = {{"step", Level::kBoundary}, {"twin", Level::kBoundary}, {"quadratic", Level::kHuman}};
  const Diagnosis d = Examine(truth);
  ASSERT_FALSE(d.left_out.empty());
  ASSERT_FALSE(d.causes.empty());
  const LevelEvidence* boundary = Of(d, Level::kBoundary);
  ASSERT_NE(boundary, nullptr);
  EXPECT_EQ(boundary->standing, LevelStanding::kBlamed);
  EXPECT_TRUE(std::isnan(boundary->delta_lr));
  EXPECT_GT(boundary->left_out, 0);
  for (const LevelEvidence& one : d.levels) {
    if (!(one.left_out > 0)) continue;
    EXPECT_LE(boundary->left_out, one.left_out);
    // The ladder has the best set of so many causes, of any level.
    EXPECT_GE(one.left_out, d.ladder[one.effects.size()].error - 1e-12);
  }
  EXPECT_THAT(LevelSentence(d), HasSubstr("boundary"));
}

TEST(LevelEvidence, WithoutAFindingThereIsNone) {
  const Diagnosis d = Examine({});
  ASSERT_EQ(d.verdict, DiagnosisVerdict::kAdequate);
  EXPECT_TRUE(d.levels.empty());
  EXPECT_EQ(LevelSentence(d), "");
}

TEST(LevelEvidence, IsTheSameForAnyNumberOfThreads) {
  LinearLaws::Truth truth;
  truth.effects = {{"stretch_size", 1}};
  truth.levels = {{"step", Level::kBoundary}, {"quadratic", Level::kHuman}};
  const Diagnosis one = Examine(truth, 1);
  const Diagnosis three = Examine(truth, 3);
  ASSERT_EQ(one.levels.size(), three.levels.size());
  ASSERT_FALSE(one.levels.empty());
  for (std::size_t i = 0; i < one.levels.size(); ++i) {
    EXPECT_EQ(one.levels[i].effects, three.levels[i].effects);
    EXPECT_EQ(one.levels[i].delta_lr, three.levels[i].delta_lr);
    EXPECT_EQ(one.levels[i].behind, three.levels[i].behind);
  }
}

}  // namespace
}  // namespace sinew
