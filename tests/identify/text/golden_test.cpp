// How the program words its results, from facts that stand here: numbers and sentences change apart. After a
// change of wording that is meant, write the files anew and read the difference:
//   SINEW_UPDATE_GOLDEN=1 ctest --preset release -R text.Golden && git diff tests/identify/text/golden
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <functional>
#include <sstream>

#include "base/text.h"
#include "identify/text/diagnosis_overview.h"
#include "identify/text/diagnosis_sentences.h"
#include "identify/text/effects.h"
#include "identify/text/findings.h"
#include "identify/text/reasons.h"
#include "identify/text/shapes.h"
#include "identify/text/warnings.h"
#include "tests/identify/support/made_up_diagnosis.h"
#include "tests/identify/text/made_up_verdicts.h"

namespace sinew::text {
namespace {

using Lines = std::vector<std::string>;
using toy::Diagnosed;
using toy::Judged;
using toy::Option;
using toy::ReasonOf;

Lines Reasons() {
  Parameter stiffness = toy::FiveParameters().setup.parameters[0];
  Lines lines;
  const auto add = [&](const Reason& reason, const std::function<void(ParameterVerdict&)>& change = {}) {
    ParameterVerdict v = Judged(0, Verdict::kNotIdentifiable, reason);
    if (change) change(v);
    lines.push_back(fmt::format("{}: {}", ToString(v.reason.kind), ReasonText(stiffness, v)));
  };
  add(ReasonOf(ReasonKind::kDetermined));
  add(ReasonOf(ReasonKind::kDetermined), [](auto& v) {
    v.reason.width_of_value = false;
    v.lower_open = true;
  });
  add(ReasonOf(ReasonKind::kDetermined), [](auto& v) { v.reason.width = 15.7; });
  add(ReasonOf(ReasonKind::kAtBound));
  add(ReasonOf(ReasonKind::kAtBound), [](auto& v) { v.reason.at_lower = true; });
  stiffness.below_lower = "the spring would have to push outwards";
  add(ReasonOf(ReasonKind::kAtBound), [](auto& v) { v.reason.at_lower = true; });
  add(ReasonOf(ReasonKind::kAtBound));
  add(ReasonOf(ReasonKind::kNoResponse));
  add(ReasonOf(ReasonKind::kNoResponse), [](auto& v) {
    v.reason.channels = {"x", "y"};
    v.reason.by_prior = true;
  });
  add(ReasonOf(ReasonKind::kNoResponseHere));
  add(ReasonOf(ReasonKind::kCompensated, {"start"}));
  add(ReasonOf(ReasonKind::kCompensated, {"o1", "o2", "o3", "o4", "o5", "o6"}));
  add(ReasonOf(ReasonKind::kCombination, {"gravity"}), [](auto& v) {
    v.reason.direction = {true, {{"mass", "kg", 0.2, 0.1}, {"gravity", "m/s2", -0.5, -0.1}}};
  });
  add(ReasonOf(ReasonKind::kFlatCost));
  add(ReasonOf(ReasonKind::kDependentResiduals));
  add(ReasonOf(ReasonKind::kWeakExcitation), [](auto& v) { v.lower_open = v.upper_open = true; });
  add(ReasonOf(ReasonKind::kPartiallyCompensated, {"start"}));
  add(ReasonOf(ReasonKind::kCorrelated, {"ramp"}));
  add(ReasonOf(ReasonKind::kCorrelated, {"ramp", "decay"}), [](auto& v) { v.reason.std_error = INFINITY; });
  add(ReasonOf(ReasonKind::kNoiseLevelUnknown), [](auto& v) {
    v.reason.residuals = 2;
    v.reason.fitted = 3;
  });
  for (const ProfileFailure failure :
       {ProfileFailure::kInterrupted, ProfileFailure::kBudgetSpent, ProfileFailure::kRefitNotConverged,
        ProfileFailure::kNoPrediction, ProfileFailure::kRoughCost})
    add(ReasonOf(ReasonKind::kDetermined), [&](auto& v) { v.reason.no_profile = failure; });
  return lines;
}

Lines Remedies() {
  const Parameter stiffness = toy::FiveParameters().setup.parameters[0];
  const RemedyOption channel = Option(AdditionKind::kChannel, "force_x", 0.03);
  const RemedyOption trial = Option(AdditionKind::kTrial, "slide", 0.1);
  const RemedyOption known = Option(AdditionKind::kKnownValue, "gravity", 0.25);
  const RemedyOption pair{{channel.additions[0], trial.additions[0]}, 0.02};
  Lines lines;
  for (const Remedy& remedy :
       {Remedy{}, Remedy{RemedyKind::kAdditions, {channel}}, Remedy{RemedyKind::kAdditions, {channel, trial}},
        Remedy{RemedyKind::kAdditions, {pair}}, Remedy{RemedyKind::kNoChannel},
        Remedy{RemedyKind::kNoChannel, {known}}, Remedy{RemedyKind::kIndependentNoise},
        Remedy{RemedyKind::kNotPredicted, {}, "no force at t = 0"}, Remedy{RemedyKind::kOtherBound},
        Remedy{RemedyKind::kMoreSamples}})
    lines.push_back(fmt::format("{}: {}", ToString(remedy.kind), RemedyText(stiffness, remedy)));
  lines.push_back("without figures: " +
                  RemedyText(stiffness, {RemedyKind::kAdditions, {channel, trial}}, false));
  return lines;
}

Lines FindingsOfAnIdentification() {
  Identification found = toy::FiveParameters();
  const Reason none = ReasonOf(ReasonKind::kNoResponse);
  const Remedy measuring_x{RemedyKind::kAdditions, {Option(AdditionKind::kChannel, "x", 0.1)}};
  const Remedy measuring_y{RemedyKind::kAdditions, {Option(AdditionKind::kChannel, "y", 0.2)}};
  found.uncertainty.parameters = {Judged(0, Verdict::kIdentifiable, {}),
                                  Judged(1, Verdict::kWeak, ReasonOf(ReasonKind::kWeakExcitation)),
                                  Judged(2, Verdict::kAtBound, ReasonOf(ReasonKind::kAtBound))};
  Lines lines = TextsOf(Findings(found));
  const auto add = [&](const Remedy& first, const Remedy& second) {
    found.uncertainty.parameters = {Judged(3, Verdict::kNotIdentifiable, none, first),
                                    Judged(4, Verdict::kNotIdentifiable, none, second)};
    for (const std::string& text : TextsOf(Findings(found))) lines.push_back(text);
  };
  add(measuring_x, measuring_x);
  add(measuring_x, measuring_y);
  add({}, {});
  found.uncertainty.parameters = {Judged(0, Verdict::kIdentifiable, {})};
  found.uncertainty.parameters[0].value = 20;
  found.uncertainty.directions = {{true, {{"a", "N/m", 2, 0.1}, {"b", "1", -3, NAN}}},
                                  {false, {{"a", "N/m", 2, 0.1}, {"b", "1", 3, 0.2}, {"c", "1", 1, 0.3}}}};
  found.pooled_fit = {{"", BlockRole::kTrain, "vertical force", "N", 0.9123, 0.9991, 100},
                      {"", BlockRole::kTrain, "joint_angle", "rad", 0.01, 0.5, 100},
                      {"", BlockRole::kValidate, "vertical force", "N", 1.234, 0.998, 50}};
  FinishedStep step;
  step.name = "step 1 (a)";
  step.setup = found.setup;
  step.uncertainty.parameters = {Judged(0, Verdict::kIdentifiable, {})};
  found.steps = {step};
  for (const std::string& text : TextsOf(Findings(found))) lines.push_back(text);
  return lines;
}

Lines EveryWarning() {
  Diagnosis d;
  d.left_out = {{{"walk_1"}, {}}, {{"walk_2", "walk_3", "walk_4"}, {}}, {{"run"}, {{0.5, 1.25}}}};
  d.warnings = {{WarningKind::kFailedEvaluations, {}, {3, 200}, "the foot slips at a = 0.3"},
                {WarningKind::kFailedEvaluations,
                 {"the foot slips at a = 0.3"},
                 {3, 200, 3},
                 "the foot slips at a = 0.3"},
                {WarningKind::kFailedEvaluations,
                 {"the robot falls", "the foot slips at a = 0.3"},
                 {5, 200, 4, 1},
                 "the foot slips at a = 0.3"},
                {WarningKind::kNotConverged, {}, {}, "200 evaluations"},
                {WarningKind::kNotAMinimum, {}, {12.5, 12.25}, {}},
                {WarningKind::kSearchUnfinished, {}, {}, {}},
                {WarningKind::kBetterFit, {}, {12.5, 12.25}, {}},
                {WarningKind::kBetterPointTaken, {}, {12.5, 12.25}, {}},
                {WarningKind::kDependentResiduals, {"force_y", "angle"}, {3.14, 0.93, 0.2}, {}},
                {WarningKind::kCompetingMinima, {"a.strength", "b.shape"}, {5, 1.4e-4, 0.82, 0.3}, {}},
                {WarningKind::kActiveConstraint, {"not_too_steep"}, {}, {}},
                {WarningKind::kHeldFromSteps, {"a"}, {}, {}},
                {WarningKind::kHeldFromSteps, {"a", "b", "c", "d", "e", "f"}, {}, {}},
                {WarningKind::kUnfinishedStart, {"run.h5"}, {}, {}},
                {WarningKind::kStatedCost, {"run.h5"}, {12.5, 12.75}, {}},
                {WarningKind::kNoiseAbsorbsMisfit, {}, {}, {}},
                {WarningKind::kEqualNoise, {}, {}, {}},
                {WarningKind::kCrossValidated, {}, {4, 4}, {}},
                {WarningKind::kCrossValidated, {}, {4, 12}, {}},
                {WarningKind::kNoiseLevelUnknown, {"angle", "smooth"}, {}, {}},
                {WarningKind::kNoiseLevelUnknown,
                 {"angle", "few_samples", "envelope", "correlated", "force", "constant"},
                 {},
                 {}},
                {WarningKind::kNoValidationTrial, {}, {}, {}},
                {WarningKind::kFreeTermExplainsMore, {"moment(angle)"}, {61.23, 55.5}, {}},
                {WarningKind::kErrorConcentration, {"moment", "walk"}, {0.423, 0.1, 3.21}, {}},
                {WarningKind::kErrorConcentration,
                 {"moment", "walk", "moment", "run", "force", "walk"},
                 {0.423, 0.1, 3.21, 0.4, 0.1, 2, 0.3, 0.1, 1},
                 {}},
                {WarningKind::kOddTrial, {"position", "swing", "rad"}, {0.52, 0.031, 6, 0}, {}},
                {WarningKind::kOddTrial, {"position", "swing", "rad"}, {0.52, 0.031, 6, 0.12}, {}},
                {WarningKind::kErrorDrift, {"position", "swing"}, {0.423, 0.1, 3.21}, {}},
                {WarningKind::kOther, {}, {}, "a sole of the data is not fitted", "step 1 (a)"}};
  return Warnings(d);
}

Lines EveryShape() {
  Lines lines;
  for (const ShapeKind kind : {ShapeKind::kNone, ShapeKind::kLinear, ShapeKind::kQuadraticOdd,
                               ShapeKind::kCubic, ShapeKind::kQuadraticEven, ShapeKind::kStep,
                               ShapeKind::kSaturating, ShapeKind::kPeak, ShapeKind::kPeriodic}) {
    const Shape shape{kind, 0.9, 2.1};
    lines.push_back(fmt::format("{}: {}; position: {}; speed: {}; time: {}; command: {}; other: {}",
                                ToString(kind), ShapeText(shape), LawText(shape, "position"),
                                LawText(shape, "speed"), LawText(shape, "time"), LawText(shape, "command"),
                                LawText(shape, "u")));
  }
  lines.push_back("explains too little: " + ShapeText({ShapeKind::kStep, 0.84}));
  return lines;
}

Lines TheWholeDiagnosis() {
  const toy::ToyProblem problem = toy::JointProblem();
  Lines lines;
  for (const Line& line : Overview(toy::JointDiagnosis(problem)))
    lines.push_back(std::string(static_cast<std::size_t>(line.indent), ' ') + line.text);
  return lines;
}

// What differs from the whole diagnosis after a change of its facts.
Lines OtherDiagnoses() {
  const toy::ToyProblem problem = toy::JointProblem();
  const Lines whole = TextsOf(Sentences(toy::JointDiagnosis(problem)));
  Lines lines;
  const auto add = [&](const char* what, const std::function<void(Diagnosis&)>& change) {
    Diagnosis d = toy::JointDiagnosis(problem);
    change(d);
    lines.push_back(fmt::format("-- {}", what));
    for (const std::string& text : TextsOf(Sentences(d))) {
      if (std::find(whole.begin(), whole.end(), text) == whole.end()) lines.push_back(text);
    }
  };
  add("adequate", [](Diagnosis& d) {
    d.verdict = DiagnosisVerdict::kAdequate;
    d.family_p_value = 0.41;
    d.causes.clear();
  });
  add("explained", [](Diagnosis& d) { d.verdict = DiagnosisVerdict::kExplained; });
  add("two causes", [](Diagnosis& d) {
    d.verdict = DiagnosisVerdict::kExplained;
    d.causes.push_back(d.causes[0]);
    d.causes[1].effect = "y.quantisation";
    d.causes[1].kind = CauseKind::kQuantisation;
    d.causes[1].channel = "y";
  });
  add("unexplained", [](Diagnosis& d) { d.verdict = DiagnosisVerdict::kUnexplained; });
  add("unexplained, no cause", [](Diagnosis& d) {
    d.verdict = DiagnosisVerdict::kUnexplained;
    d.causes.clear();
  });
  add("strongly autocorrelated", [](Diagnosis& d) {
    d.verdict = DiagnosisVerdict::kUnexplained;
    d.strongly_autocorrelated = true;
  });
  add("base fit not converged", [](Diagnosis& d) { d.inconclusive = Inconclusive::kBaseFitNotConverged; });
  add("noise too large", [](Diagnosis& d) { d.inconclusive = Inconclusive::kNoiseTooLarge; });
  add("withdrawn by cross-validation", [](Diagnosis& d) {
    d.withdrawn[0].delta_lr = d.withdrawn[0].held_out_loss = NAN;
    d.withdrawn[0].worst.reset();
  });
  add("withdrawn beside an unknown term", [](Diagnosis& d) {
    d.withdrawn[0].terms = {"torque(position)", "torque(time)"};
  });
  add("unknown terms chosen by cross-validation", [](Diagnosis& d) {
    d.left_out = {{{"slow"}, {}}};
    d.unknown_terms.push_back(d.unknown_terms[0]);
  });
  add("chosen by cross-validation", [](Diagnosis& d) { d.causes[0].left_out = 0.6; });
  add("less common", [](Diagnosis& d) { d.alternatives[0].less_common = true; });
  add("same class", [](Diagnosis& d) { d.alternatives[0].same_class = true; });
  add("more general law", [](Diagnosis& d) { d.alternatives[0].contains_cause = true; });
  add("separated by a larger effect", [](Diagnosis& d) { d.alternatives[0].separating_size = 9; });
  add("overestimated", [](Diagnosis& d) { d.base_parameters[0].value = 1.404; });
  add("overestimated many times", [](Diagnosis& d) { d.base_parameters[0].value = 1e6; });
  add("underestimated", [](Diagnosis& d) { d.base_parameters[0].value = 0.6; });
  add("negative", [](Diagnosis& d) {
    d.base_parameters[0].value = -0.127;
    d.extended_parameters[0].value = -0.983;
  });
  add("other sign", [](Diagnosis& d) { d.base_parameters[0].value = -1; });
  add("at bound", [](Diagnosis& d) { d.base_parameters[0].at_bound = "upper"; });
  add("all of the error", [](Diagnosis& d) { d.gain[0].gap_closed = 1; });
  add("nothing of the error", [](Diagnosis& d) { d.gain[0].gap_closed = NAN; });
  add("no held-out trial", [](Diagnosis& d) { d.has_held_out = false; });
  add("worse trials", [](Diagnosis& d) {
    for (const char* name : {"one", "two", "three", "four"})
      d.traces.push_back({name, BlockRole::kValidate, "y", "N", {0, 1}, {0, 0}, {1, 1}, {2, 2}});
  });
  add("a parameter drifts", [](Diagnosis& d) {
    d.unknown_terms[0].kind = UnknownKind::kDrift;
    d.unknown_terms[0].port = "rate";
  });
  add("a line in the spectrum, or a curve", [](Diagnosis& d) {
    d.unknown_terms.push_back(d.unknown_terms[0]);
    d.unknown_terms[0].kind = UnknownKind::kPeriodic;
    d.unknown_terms[0].frequency = 1.6;
    d.unknown_terms[1].shape = {ShapeKind::kLinear, 0.5};
    d.unknown_terms[1].signal = "u";
  });
  add("a value at its bound", [](Diagnosis& d) {
    d.causes[0].parameters[0].std_error = NAN;
    d.causes[0].parameters[0].at_bound = "upper";
  });
  return lines;
}

struct Case {
  const char* name;
  Lines (*lines)();
};

class Golden : public testing::TestWithParam<Case> {};

TEST_P(Golden, TextIsThatOfTheFile) {
  const std::string path =
      fmt::format("{}/tests/identify/text/golden/{}.txt", SINEW_SOURCE_DIR, GetParam().name);
  const std::string text = Join(GetParam().lines(), "\n") + "\n";
  if (std::getenv("SINEW_UPDATE_GOLDEN") != nullptr) std::ofstream(path) << text;
  std::ifstream file(path);
  std::ostringstream approved;
  approved << file.rdbuf();
  EXPECT_EQ(text, approved.str()) << "if this wording is meant: SINEW_UPDATE_GOLDEN=1 ctest -R text.Golden, "
                                     "then read the difference of "
                                  << path;
}

INSTANTIATE_TEST_SUITE_P(Text, Golden,
                         testing::Values(Case{"reasons", Reasons}, Case{"remedies", Remedies},
                                         Case{"findings", FindingsOfAnIdentification},
                                         Case{"warnings", EveryWarning}, Case{"shapes", EveryShape},
                                         Case{"diagnosis", TheWholeDiagnosis},
                                         Case{"other_diagnoses", OtherDiagnoses}),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace sinew::text
