// The JSON of `diagnose` is what scripts rely on: its fields are those of the contract.
#include "identify/files/diagnosis_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "tests/identify/support/made_up_diagnosis.h"

namespace sinew {
namespace {

using Json = nlohmann::json;
using testing::IsEmpty;

const Provenance kDiagnosisJsonProvenance{"joint", "data.h5", "0123456789abcdef", "a joint", "", false};

class DiagnosisJsonTest : public testing::Test {
 protected:
  [[nodiscard]] Json Parse(const Provenance& provenance = kDiagnosisJsonProvenance) const {
    DiagnosisOptions options;
    options.seed = 42;
    return Json::parse(files::DiagnosisJson(diagnosis_, provenance, options), nullptr, false);
  }
  /// Names in a list of findings.
  static std::vector<std::string> Effects(const Json& list) {
    std::vector<std::string> names;
    for (const Json& item : list) names.push_back(item["effect"]);
    return names;
  }
  const toy::ToyProblem problem_ = toy::JointProblem();
  Diagnosis diagnosis_ = toy::JointDiagnosis(problem_);
};

TEST_F(DiagnosisJsonTest, HasTheFieldsOfTheContract) {
  const Json json = Parse();
  ASSERT_TRUE(json.is_object());
  EXPECT_EQ(json["schema"], "sinew.diagnosis/1");
  EXPECT_EQ(json["problem"], "joint");
  EXPECT_EQ(json["seed"], 42);
  EXPECT_EQ(json["verdict"], "ambiguous");
  ASSERT_EQ(json["sentences"].size(), 8U);
  ASSERT_EQ(json["sentence_facts"].size(), 8U);
  EXPECT_EQ(json["sentence_facts"][4],
            Json({{"kind", "alternative"}, {"about", {"y.delay", "friction"}}, {"step", ""}}));
  EXPECT_EQ(json["warnings"], Json({"only one held-out trial"}));
  EXPECT_EQ(json["warning_facts"][0]["kind"], "other");

  EXPECT_EQ(json["base"]["fit"][1]["role"], "validate");
  EXPECT_EQ(json["base"]["fit"][1]["rmse"], 0.6);
  EXPECT_EQ(json["base"]["noise_floor"][0]["sigma"], 0.1);
  EXPECT_EQ(json["base"]["tests"][0]["test"], "Ljung-Box");
  EXPECT_EQ(json["base"]["stop_reason"], "cost_change");
  EXPECT_EQ(json["base"]["parameters"][0]["name"], "rate");

  const Json& structure = json["structure"][0];
  EXPECT_EQ(structure["channel"], "y");
  EXPECT_EQ(structure["signal"], "speed");
  EXPECT_EQ(structure["explained_fraction"], 0.31);
  EXPECT_TRUE(structure["shape"].is_string());
  EXPECT_EQ(structure["shape_kind"], "step");

  const Json& cause = json["causes"][0];
  EXPECT_EQ(cause["effect"], "friction");
  EXPECT_EQ(cause["level"], "robot");
  EXPECT_EQ(cause["sentence"], "dry friction brakes the joint");
  EXPECT_EQ(cause["p_value"], 1e-12);
  EXPECT_EQ(cause["delta_bic"], 75);
  const Json& level = cause["parameters"][0];
  EXPECT_EQ(level["name"], "friction_level");
  EXPECT_EQ(level["value"], 0.7);
  EXPECT_EQ(level["unit"], "N");
  EXPECT_EQ(level["std_error"], 0.05);
  EXPECT_EQ(level["ci95"], Json({0.7 - 2 * 0.05, 0.7 + 2 * 0.05}));

  EXPECT_EQ(json["levels"][1], Json({{"level", "sensor"},
                                     {"standing", "possible"},
                                     {"effects", {"y.delay"}},
                                     {"parameters", 1},
                                     {"delta_lr", 76.9},
                                     {"behind", 3.1},
                                     {"left_out", 0.0}}));

  const Json& alternative = json["alternatives"][0];
  EXPECT_EQ(alternative["instead_of"], "friction");
  EXPECT_EQ(alternative["effect"], "y.delay");
  EXPECT_EQ(alternative["delta_lr"], 3.1);
  EXPECT_TRUE(alternative.contains("delta_bic"));
  EXPECT_EQ(alternative["separating_size"], 2.5);
  EXPECT_EQ(alternative["separated_by"], "a trial at two speeds");

  const Json& gain = json["gain"];
  EXPECT_EQ(gain["channel"], "y");
  EXPECT_EQ(gain["unit"], "N");
  EXPECT_EQ(gain["validate_rmse_before"], 0.6);
  EXPECT_EQ(gain["validate_rmse_after"], 0.15);
  EXPECT_EQ(gain["reduction"], 0.75);
  EXPECT_EQ(gain["ci95"], Json({0.6, 0.8}));
  EXPECT_EQ(gain["gap_closed"], 0.9);

  const Json& term = json["unknown_terms"][0];
  EXPECT_EQ(term["port"], "torque");
  EXPECT_EQ(term["signal"], "speed");
  EXPECT_TRUE(term["shape"].is_string());
  EXPECT_EQ(term["shape_kind"], "step");
  EXPECT_EQ(term["nearest_law"], "Coulomb friction");
  EXPECT_EQ(json["extended_parameters"][1]["name"], "friction_level");
}

// Each effect is in exactly one list of findings.
TEST_F(DiagnosisJsonTest, EveryEffectHasOneFinding) {
  const Json json = Parse();
  EXPECT_THAT(Effects(json["causes"]), testing::ElementsAre("friction"));
  EXPECT_THAT(Effects(json["alternatives"]), testing::ElementsAre("y.delay"));
  EXPECT_THAT(Effects(json["withdrawn"]), testing::ElementsAre("y.gain"));
  EXPECT_THAT(Effects(json["ruled_out"]), testing::ElementsAre("y.offset"));
  EXPECT_THAT(Effects(json["not_judged"]), testing::ElementsAre("y.drift"));
  EXPECT_EQ(json["ruled_out"][0]["p_value"], 0.4);
  EXPECT_EQ(json["ruled_out"][0]["smallest_detectable"],
            Json({{"parameter", "y.offset"}, {"value", 0.02}, {"unit", "N"}}));
  EXPECT_TRUE(json["not_judged"][0]["why"].is_string());
  EXPECT_EQ(json["not_judged"][0]["why_kind"], "no_distinct_change");
  EXPECT_EQ(json["withdrawn"][0]["delta_lr"], 30);
  EXPECT_EQ(json["withdrawn"][0]["worst"]["trial"], "check");
  EXPECT_EQ(json["withdrawn"][0]["terms"], Json::array());
  ASSERT_EQ(json["scores"].size(), diagnosis_.scores.size());
  EXPECT_EQ(json["scores"][3]["finding"], "unknown_term");
  EXPECT_EQ(json["scores"][4]["finding"], "ruled_out");
}

// A discrepancy term that was not found is no effect that could be ruled out.
TEST_F(DiagnosisJsonTest, UnknownTermsAreNotAmongTheEffectsRuledOut) {
  diagnosis_.unknown_terms.clear();
  const Json json = Parse();
  EXPECT_THAT(Effects(json["ruled_out"]), testing::ElementsAre("y.offset"));
  EXPECT_EQ(json["scores"][3]["finding"], "ruled_out");
}

TEST_F(DiagnosisJsonTest, WhatIsNotFiniteOrNotThereIsNull) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  diagnosis_.alternatives[0].separating_size = std::numeric_limits<double>::infinity();
  diagnosis_.causes[0].parameters[0].std_error = nan;
  diagnosis_.causes[0].parameters[0].ci95 = {nan, nan};
  diagnosis_.scores[4].smallest_detectable = 0;
  diagnosis_.gain[0].gap_closed = nan;
  diagnosis_.structure[0].curve[1] = nan;
  Json json = Parse();
  ASSERT_TRUE(json.is_object());
  EXPECT_TRUE(json["alternatives"][0]["separating_size"].is_null());
  EXPECT_TRUE(json["causes"][0]["parameters"][0]["std_error"].is_null());
  EXPECT_TRUE(json["causes"][0]["parameters"][0]["ci95"].is_null());
  EXPECT_TRUE(json["ruled_out"][0]["smallest_detectable"].is_null());
  EXPECT_TRUE(json["gain"]["gap_closed"].is_null());
  EXPECT_TRUE(json["structure"][0]["curve"][1].is_null());
  EXPECT_TRUE(json["scores"][4]["delta_lr"].is_null()) << "it was not refitted";

  diagnosis_.gain.clear();
  json = Parse();
  EXPECT_TRUE(json["gain"].is_null());
  EXPECT_THAT(json["gains"], IsEmpty());
}

// A friction that no channel depends on: no interval of width zero.
TEST_F(DiagnosisJsonTest, AParameterThatIsNotDeterminedHasNoInterval) {
  diagnosis_.base_parameters[0].std_error = 0;
  diagnosis_.base_parameters[0].ci95 = {1.5, 1.5};
  const Json parameter = Parse()["base"]["parameters"][0];
  EXPECT_EQ(parameter["value"], 1.5);
  EXPECT_TRUE(parameter["std_error"].is_null());
  EXPECT_TRUE(parameter["ci95"].is_null());
}

TEST_F(DiagnosisJsonTest, AnEmptyDiagnosisHasEveryField) {
  const Json full = Parse();
  diagnosis_ = {};
  const Json json = Parse();
  ASSERT_TRUE(json.is_object());
  for (const auto& [key, value] : full.items()) EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_EQ(json["verdict"], "adequate");
}

TEST_F(DiagnosisJsonTest, NamesThatAreNotUnicodeStillGiveJson) {
  Provenance provenance = kDiagnosisJsonProvenance;
  provenance.data_file = "caf\xe9.h5";
  EXPECT_EQ(Parse(provenance)["data"], "caf\xef\xbf\xbd.h5");  // the replacement character
}

}  // namespace
}  // namespace sinew
