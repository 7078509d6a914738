// The diagnosis from end to end on a problem whose answers are known by hand.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "identify/diagnosis/diagnosis.h"
#include "tests/identify/diagnosis/linear_laws.h"

namespace sinew {
namespace {

Diagnosis Examine(const LinearLaws& problem) {
  auto setup = MakeFitSetup(problem, {});
  EXPECT_TRUE(setup);
  auto diagnosis = Diagnose(problem, *setup, {});
  EXPECT_TRUE(diagnosis) << diagnosis.error().message;
  return diagnosis ? *diagnosis : Diagnosis{};
}

bool InStatedSet(const Diagnosis& d, const std::string& effect) {
  const auto is = [&](const auto& stated) { return stated.effect == effect; };
  return std::any_of(d.causes.begin(), d.causes.end(), is) ||
         std::any_of(d.alternatives.begin(), d.alternatives.end(), is);
}

TEST(Diagnose, SaysAdequateWhenNothingIsWrongAsOftenAsItClaims) {
  // 400 cases at 5 %: 20 expected, standard deviation 4.4; four of them above or below is the limit.
  for (const double correlation : {0.0, 0.8}) {
    int alarms = 0;
    for (std::uint64_t seed = 1; seed <= 400; ++seed) {
      LinearLaws::Truth truth;
      truth.correlation = correlation;
      const Diagnosis d = Examine(LinearLaws(truth, seed));
      alarms += d.verdict != DiagnosisVerdict::kAdequate ? 1 : 0;
    }
    std::printf("correlation %g: %d alarms in 400\n", correlation, alarms);
    EXPECT_LE(alarms, 38) << correlation;
    EXPECT_GE(alarms, 3) << correlation;
  }
}

TEST(Diagnose, NamesOneEffectAndMeasuresItsGain) {
  LinearLaws::Truth truth;
  truth.effects = {{"quadratic_size", 0.05}};
  const Diagnosis d = Examine(LinearLaws(truth, 7));
  ASSERT_EQ(d.causes.size(), 1U);
  EXPECT_EQ(d.causes[0].effect, "quadratic");
  EXPECT_LT(d.causes[0].p_value, 1e-3);
  ASSERT_EQ(d.causes[0].parameters.size(), 1U);
  EXPECT_LT(d.causes[0].parameters[0].ci95[0], 0.05);
  EXPECT_GT(d.causes[0].parameters[0].ci95[1], 0.05);
  ASSERT_EQ(d.gain.size(), 1U);
  EXPECT_GT(d.gain[0].reduction, 0);
  EXPECT_TRUE(d.withdrawn.empty());
}

TEST(Diagnose, TwinsAreStatedTogether) {
  LinearLaws::Truth truth;
  truth.effects = {{"step_size", 0.05}};
  const Diagnosis d = Examine(LinearLaws(truth, 3));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::kAmbiguous);
  EXPECT_TRUE(InStatedSet(d, "step"));
  EXPECT_TRUE(InStatedSet(d, "twin"));
  for (const Alternative& other : d.alternatives) {
    if (other.effect != "twin" && other.effect != "step") continue;
    EXPECT_TRUE(other.same_class);
    EXPECT_GT(other.correlation, 0.99);
    EXPECT_GT(other.separating_size, 4);
  }
}

TEST(Diagnose, FindsTwoCausesAtOnce) {
  LinearLaws::Truth truth;
  truth.effects = {{"quadratic_size", 0.05}, {"drift_size", 0.01}};
  const Diagnosis d = Examine(LinearLaws(truth, 5));
  EXPECT_EQ(d.causes.size(), 2U);
  EXPECT_TRUE(InStatedSet(d, "quadratic"));
  EXPECT_TRUE(InStatedSet(d, "drift"));
}

TEST(Diagnose, BlamesTheOneTrialThatStandsOut) {
  LinearLaws::Truth truth;
  truth.effects = {{"offset_size", 0.1}};
  truth.only_trial = "trial_3";
  const Diagnosis d = Examine(LinearLaws(truth, 5));
  ASSERT_FALSE(d.causes.empty());
  EXPECT_EQ(d.causes[0].effect, "offset@trial_3");
}

TEST(Diagnose, SaysThatTheCauseIsNotInTheLibrary) {
  LinearLaws::Truth truth;
  truth.unknown = 0.1;
  const Diagnosis d = Examine(LinearLaws(truth, 5));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::kUnexplained);
  ASSERT_FALSE(d.unknown_terms.empty());
  EXPECT_EQ(d.unknown_terms[0].signal, "u");
  EXPECT_GT(d.unknown_terms[0].held_out_reduction, 0.05);
}

TEST(Diagnose, JudgesNothingThatTheDataDoNotContain) {
  const Diagnosis d = Examine(LinearLaws({}, 2));
  const auto absent = std::find_if(d.scores.begin(), d.scores.end(),
                                   [](const EffectScore& score) { return score.effect == "absent"; });
  ASSERT_NE(absent, d.scores.end());
  EXPECT_FALSE(absent->judged);
  EXPECT_FALSE(absent->why_not.empty());
}

TEST(Diagnose, SaysWhatAMissingValidationTrialMeans) {
  LinearLaws::Truth truth;
  truth.effects = {{"quadratic_size", 0.2}};
  const Diagnosis d = Examine(LinearLaws(truth, 5, 4, 0));
  ASSERT_FALSE(d.causes.empty());
  EXPECT_TRUE(d.gain.empty());
  EXPECT_FALSE(d.warnings.empty());
}

TEST(Diagnose, NeedsSomethingToJudge) {
  const LinearLaws problem({}, 1, 1, 1, 10);
  auto setup = MakeFitSetup(problem, {});
  ASSERT_TRUE(setup);
  const auto diagnosis = Diagnose(problem, *setup, {});
  ASSERT_FALSE(diagnosis);
  EXPECT_NE(diagnosis.error().message.find("too few"), std::string::npos);
}

TEST(Diagnose, TheAnswerDoesNotDependOnThreads) {
  LinearLaws::Truth truth;
  truth.effects = {{"quadratic_size", 0.05}, {"drift_size", 0.01}};
  const LinearLaws problem(truth, 5);
  auto setup = MakeFitSetup(problem, {});
  DiagnosisOptions options;
  const auto one = Diagnose(problem, *setup, options);
  options.threads = 3;
  const auto three = Diagnose(problem, *setup, options);
  ASSERT_TRUE(one && three);
  EXPECT_EQ(one->sentences, three->sentences);
  EXPECT_EQ(one->extended_point, three->extended_point);
}

}  // namespace
}  // namespace sinew
