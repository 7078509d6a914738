// The JSON of `identify` is what scripts rely on: its fields are those of the contract.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "identify/files/run_file.h"
#include "tests/identify/support/line_fit.h"

namespace sinew {
namespace {

using Json = nlohmann::json;

const Provenance kRunJsonProvenance{"line", "data.h5", "0123456789abcdef", "a line", "", false};

class RunJsonTest : public testing::Test {
 protected:
  [[nodiscard]] Json Parse(const Provenance& provenance = kRunJsonProvenance) const {
    return Json::parse(RunJson(problem_, line_, provenance), nullptr, false);
  }
  const toy::ToyProblem problem_ = toy::LineProblem();
  Identification line_ = toy::IdentifyLine(problem_);
};

TEST_F(RunJsonTest, HasTheFieldsOfTheContract) {
  const Json json = Parse();
  ASSERT_TRUE(json.is_object());
  EXPECT_EQ(json["schema"], "sinew.run/1");
  EXPECT_EQ(json["problem"], "line");
  EXPECT_EQ(json["solver"], "restarts");
  EXPECT_EQ(json["stop_reason"], ToString(line_.result.stop.kind));
  EXPECT_EQ(json["evaluations"], line_.record.evaluations());
  EXPECT_EQ(json["cost"], line_.result.cost);
  EXPECT_TRUE(json["seconds"].is_number());
  EXPECT_TRUE(json["warnings"].is_array());
  ASSERT_EQ(json["findings"].size(), 3U) << "two parameters and one quantity";
  EXPECT_EQ(json["finding_facts"][1], Json({{"kind", "identifiable"}, {"about", {"slope"}}, {"step", ""}}));
  EXPECT_EQ(json["finding_facts"][2]["kind"], "prediction");
  EXPECT_TRUE(json["open_directions"].is_array());
  EXPECT_TRUE(json["warning_facts"].is_array());

  ASSERT_EQ(json["parameters"].size(), 2U);
  const Json& slope = json["parameters"][1];
  EXPECT_EQ(slope["name"], "slope");
  EXPECT_EQ(slope["value"], line_.parameters[1]);
  EXPECT_EQ(slope["unit"], "1");
  EXPECT_EQ(slope["lower"], -10);
  EXPECT_EQ(slope["upper"], 10);
  EXPECT_EQ(slope["std_error"], line_.uncertainty.parameters[1].std_error);
  ASSERT_EQ(slope["ci95"].size(), 2U);
  EXPECT_LT(slope["ci95"][0], slope["value"]);
  EXPECT_GT(slope["ci95"][1], slope["value"]);
  EXPECT_EQ(slope["verdict"], "identifiable");
  EXPECT_TRUE(slope["reason"].is_string());
  EXPECT_EQ(slope["reason_kind"], "determined");
  EXPECT_EQ(slope["remedy"], "");
  EXPECT_EQ(slope["remedy_kind"], "none");
  EXPECT_TRUE(slope["remedies"].empty());

  ASSERT_EQ(json["fit"].size(), 2U);
  const Json& check = json["fit"][1];
  EXPECT_EQ(check["trial"], "check");
  EXPECT_EQ(check["role"], "validate");
  EXPECT_EQ(check["channel"], "y");
  EXPECT_EQ(check["unit"], "1");
  EXPECT_EQ(check["rmse"], line_.prediction.quality[1].rmse);
  EXPECT_EQ(check["r2"], line_.prediction.quality[1].r2);
  EXPECT_EQ(check["n"], 20);
}

TEST_F(RunJsonTest, ReasonsRemediesAndDirectionsAreFacts) {
  ParameterVerdict& slope = line_.uncertainty.parameters[1];
  slope.reason.kind = ReasonKind::kCombination;
  slope.reason.partners = {"offset"};
  slope.remedy = {RemedyKind::kAdditions,
                  {{{{AdditionKind::kChannel, "z"}, {AdditionKind::kTrial, "check"}}, 0.5}}};
  line_.uncertainty.directions = {{true, {{"offset", "1", 2, 0.5}, {"slope", "1", -3, NAN}}}};
  line_.warnings = {{WarningKind::kNotAMinimum, {}, {2, 1}, {}}};
  const Json json = Parse();
  const Json& parameter = json["parameters"][1];
  EXPECT_EQ(parameter["reason_kind"], "combination");
  EXPECT_EQ(parameter["reason_partners"], Json({"offset"}));
  EXPECT_EQ(parameter["remedy_kind"], "additions");
  const Json& remedy = parameter["remedies"][0];
  EXPECT_EQ(remedy["std_error"], 0.5);
  EXPECT_EQ(remedy["additions"][0], Json({{"kind", "channel"}, {"name", "z"}}));
  EXPECT_EQ(remedy["additions"][1], Json({{"kind", "trial"}, {"name", "check"}}));
  const Json& direction = json["open_directions"][0];
  EXPECT_EQ(direction["lost"], true);
  EXPECT_EQ(direction["changes"][0]["relative"], 0.5);
  EXPECT_TRUE(direction["changes"][1]["relative"].is_null());
  EXPECT_EQ(json["warning_facts"][0]["kind"], "not_a_minimum");
  EXPECT_EQ(json["warning_facts"][0]["numbers"], Json({2, 1}));
}

TEST_F(RunJsonTest, WhatIsNotFiniteIsNull) {
  line_.result.cost = std::numeric_limits<double>::infinity();
  line_.prediction.quality[0].r2 = std::numeric_limits<double>::quiet_NaN();
  line_.uncertainty.parameters[0].std_error = std::numeric_limits<double>::infinity();
  line_.uncertainty.parameters[0].interval = IntervalKind::kNone;
  const Json json = Parse();
  ASSERT_TRUE(json.is_object());
  EXPECT_TRUE(json["cost"].is_null());
  EXPECT_TRUE(json["fit"][0]["r2"].is_null());
  EXPECT_TRUE(json["parameters"][0]["std_error"].is_null());
  EXPECT_TRUE(json["parameters"][0]["ci95"].is_null());
}

// File names are bytes; a name in Latin-1 must not end the program.
TEST_F(RunJsonTest, NamesThatAreNotUnicodeStillGiveJson) {
  Provenance provenance = kRunJsonProvenance;
  provenance.data_file = "caf\xe9.h5";
  const Json json = Parse(provenance);
  ASSERT_TRUE(json.is_object());
  EXPECT_EQ(json["data"], "caf\xef\xbf\xbd.h5");  // the replacement character
}

}  // namespace
}  // namespace sinew
