// Which sentences there are, and about what; how they read stands in golden/.
#include "identify/text/diagnosis_sentences.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "tests/identify/support/made_up_diagnosis.h"

namespace sinew::text {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::Not;
using toy::Diagnosed;

/// "cause friction", "worse_trial fast y", in the order of the sentences.
std::vector<std::string> Facts(const std::function<void(Diagnosis&)>& change) {
  const toy::ToyProblem problem = toy::JointProblem();
  Diagnosis d = toy::JointDiagnosis(problem);
  change(d);
  std::vector<std::string> facts;
  for (const Sentence& sentence : Sentences(d)) {
    facts.emplace_back(ToString(sentence.kind));
    for (const std::string& name : sentence.about) facts.back() += " " + name;
  }
  return facts;
}

TEST(DiagnosisSentences, EveryFindingIsTold) {
  EXPECT_THAT(Facts([](Diagnosis&) {}),
              ElementsAre("withdrawn y.gain", "verdict", "level robot sensor", "cause friction",
                          "alternative y.delay friction", "unknown_term torque(speed)",
                          "parameter_change rate", "gain y"));
}

TEST(DiagnosisSentences, ParametersThatACurveCannotBeSeparatedFromAreNamed) {
  const auto text = [](const std::vector<std::string>& parameters) {
    const toy::ToyProblem problem = toy::JointProblem();
    Diagnosis d = toy::JointDiagnosis(problem);
    d.unknown_terms[0].inseparable_from = parameters;
    for (const Sentence& sentence : Sentences(d)) {
      if (sentence.kind == SentenceKind::kUnknownTerm) return sentence.text;
    }
    return std::string();
  };
  EXPECT_THAT(text({"stiffness", "gain"}), testing::HasSubstr("the same as a change of stiffness, gain:"));
  EXPECT_THAT(text({}), Not(testing::HasSubstr("the same as")));
}

TEST(DiagnosisSentences, ACauseWhoseIntervalContainsItsNullSaysSo) {
  const auto text = [](bool contains) {
    const toy::ToyProblem problem = toy::JointProblem();
    Diagnosis d = toy::JointDiagnosis(problem);
    d.causes[0].interval_contains_null = contains;
    for (const Sentence& sentence : Sentences(d)) {
      if (sentence.kind == SentenceKind::kCause) return sentence.text;
    }
    return std::string();
  };
  EXPECT_THAT(text(true), testing::HasSubstr("; its interval contains the value without this effect"));
  EXPECT_THAT(text(false), Not(testing::HasSubstr("its interval contains")));
}

TEST(DiagnosisSentences, ALawThatContainsTheCauseIsNoAlternative) {
  EXPECT_THAT(Facts([](Diagnosis& d) { d.alternatives[0].contains_cause = true; }),
              Contains("more_general_law y.delay friction"));
}

TEST(DiagnosisSentences, AnAlternativeThatTakesTurnsWithTheCauseSaysSo) {
  const auto text = [](double left_out) {
    const toy::ToyProblem problem = toy::JointProblem();
    Diagnosis d = toy::JointDiagnosis(problem);
    d.alternatives[0].left_out = left_out;
    for (const Sentence& sentence : Sentences(d)) {
      if (sentence.kind == SentenceKind::kAlternative) return sentence.text;
    }
    return std::string();
  };
  EXPECT_THAT(text(1.1),
              testing::HasSubstr("is 110 % of that with the cause, but which of the two is chosen"));
  EXPECT_THAT(text(1.04), Not(testing::HasSubstr("which of the two")));
}

TEST(DiagnosisSentences, AVerdictSaysOfWhichChannelsTheNoiseIsUnknown) {
  const auto verdict = [](DiagnosisVerdict is, std::vector<std::string> unknown) {
    const toy::ToyProblem problem = toy::JointProblem();
    Diagnosis d = toy::JointDiagnosis(problem);
    d.verdict = is;
    if (!unknown.empty()) d.warnings.push_back({WarningKind::kNoiseLevelUnknown, std::move(unknown), {}, {}});
    for (const Sentence& sentence : Sentences(d)) {
      if (sentence.kind == SentenceKind::kVerdict) return sentence.text;
    }
    return std::string();
  };
  for (const DiagnosisVerdict is :
       {DiagnosisVerdict::kAdequate, DiagnosisVerdict::kExplained, DiagnosisVerdict::kAmbiguous}) {
    EXPECT_THAT(verdict(is, {"y", "smooth", "z", "constant"}),
                testing::HasSubstr("The noise level of y and z is not known"));
    EXPECT_THAT(verdict(is, {}), Not(testing::HasSubstr("noise")));
  }
}

TEST(DiagnosisSentences, AChangeWithinChanceIsNotTold) {
  const auto moved = [](double before, double now) {
    return Facts([&](Diagnosis& d) {
      d.base_parameters = {Diagnosed("rate", before, 0.1, before)};
      d.extended_parameters[0] = Diagnosed("rate", now, 0.02, before);
    });
  };
  EXPECT_THAT(moved(1.5, 1.2), Contains("parameter_change rate"));
  EXPECT_THAT(moved(1.21, 1.2), Not(Contains("parameter_change rate"))) << "within its interval";
  EXPECT_THAT(moved(100.1, 100), Not(Contains("parameter_change rate"))) << "less than half a percent";
  EXPECT_THAT(moved(0, 1.2), Contains("parameter_change rate"));
}

TEST(DiagnosisSentences, HeldOutTrialsThatGetWorseAreNamed) {
  const auto with = [](double first, double second) {
    return Facts([&](Diagnosis& d) {
      d.traces = {{"slow", BlockRole::kTrain, "y", "N", {0, 1}, {0, 0}, {1, 1}, {9, 9}},
                  {"check", BlockRole::kValidate, "y", "N", {0, 1}, {0, 0}, {1, 1}, {first, first}},
                  {"fast", BlockRole::kValidate, "y", "N", {0, 1}, {0, 0}, {1, 1}, {second, second}}};
    });
  };
  EXPECT_THAT(with(0.5, 1.01), Not(Contains("worse_trial fast y"))) << "one percent is nothing";
  const auto worse = with(0.5, 2);
  EXPECT_THAT(worse, Contains("worse_trial fast y"));
  EXPECT_THAT(worse, Not(Contains("worse_trial check y")));
  EXPECT_THAT(worse, Not(Contains("worse_trial slow y"))) << "it was fitted";
}

TEST(DiagnosisSentences, WithoutHeldOutTrialsNoGainIsTold) {
  EXPECT_THAT(Facts([](Diagnosis& d) {
                d.has_held_out = false;
                d.gain.clear();
              }),
              testing::IsSupersetOf({"no_held_out_trial"}));
}

TEST(DiagnosisSentences, AnInconclusiveDiagnosisNamesNoCause) {
  for (const Inconclusive why : {Inconclusive::kBaseFitNotConverged, Inconclusive::kNoiseTooLarge}) {
    EXPECT_THAT(Facts([&](Diagnosis& d) { d.inconclusive = why; }), ElementsAre("inconclusive", "advice"));
  }
}

TEST(DiagnosisSentences, AnAdequateModelComesWithDetectableSizes) {
  EXPECT_THAT(Facts([](Diagnosis& d) {
                d.verdict = DiagnosisVerdict::kAdequate;
                d.levels.clear();
                d.causes.clear();
                d.alternatives.clear();
                d.withdrawn.clear();
                d.unknown_terms.clear();
              }),
              ElementsAre("verdict", "detectable y.offset"));
}

}  // namespace
}  // namespace sinew::text
