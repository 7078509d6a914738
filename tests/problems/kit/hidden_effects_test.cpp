#include "problems/kit/hidden_effects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "problems/registry.h"

namespace sinew {
namespace {

using testing::HasSubstr;
using testing::Pair;
using testing::UnorderedElementsAre;

ParameterList Effects() {
  ParameterList list;
  ParameterListBuilder add(list);
  add.BeginEffect("drag", Level::kBoundary, "", "");
  add.AddNumber("drag_coefficient", "1/m", "", 0, 2);
  add.BeginEffect("tilt", Level::kSensor, "", "");
  add.AddNumber("tilt_x", "rad", "", -0.1, 0.1);
  add.AddNumber("tilt_z", "rad", "", -0.1, 0.1);
  return list;
}

ParameterList Outsiders() {
  constexpr Outsider kOutsiders[] = {{"hum", "N", "a sine of time"}};
  return ListOutsiders(kOutsiders);
}

Result<std::map<std::string, double>> Read(const RequestedEffects& requested) {
  return ReadHiddenEffects(requested, Effects(), Outsiders());
}

std::string ErrorOf(const RequestedEffects& requested) {
  const auto hidden = Read(requested);
  return hidden ? "" : hidden.error().message;
}

TEST(ReadHiddenEffects, GivesValuesByParameter) {
  const auto hidden = Read({{"drag", {{"drag_coefficient", 1.5}}}, {"hum", {{"hum", -3}}}});
  ASSERT_TRUE(hidden);
  EXPECT_THAT(*hidden, UnorderedElementsAre(Pair("drag_coefficient", 1.5), Pair("hum", -3)));
}

TEST(ReadHiddenEffects, AnEffectOfOneParameterTakesValue) {
  const auto hidden = Read({{"drag", {{"value", 0.5}}}});
  ASSERT_TRUE(hidden);
  EXPECT_THAT(*hidden, UnorderedElementsAre(Pair("drag_coefficient", 0.5)));
  EXPECT_THAT(ErrorOf({{"tilt", {{"value", 0.05}}}}), HasSubstr("--effect tilt: 'value' does not exist"));
}

TEST(ReadHiddenEffects, AnEffectWithoutANumberNamesTheParametersThatItTakes) {
  EXPECT_EQ(ErrorOf({{"drag", {}}}), "--effect drag: expected drag:drag_coefficient=NUMBER");
  EXPECT_EQ(ErrorOf({{"tilt", {}}}), "--effect tilt: expected tilt:tilt_x=NUMBER,tilt_z=NUMBER");
  EXPECT_EQ(ErrorOf({{"hum", {}}}), "--effect hum: expected hum:hum=NUMBER");
}

TEST(ReadHiddenEffects, UnknownNamesAreErrorsWithASuggestion) {
  EXPECT_EQ(ErrorOf({{"dragg", {}}}), "--effect: 'dragg' does not exist; did you mean 'drag'?");
  EXPECT_EQ(ErrorOf({{"humm", {}}}), "--effect: 'humm' does not exist; did you mean 'hum'?");
  EXPECT_EQ(ErrorOf({{"", {}}}).rfind("--effect: '' does not exist", 0), 0U);
  EXPECT_EQ(ErrorOf({{"tilt", {{"tilt_y", 0}}}}),
            "--effect tilt: 'tilt_y' does not exist; did you mean 'tilt_x'?");
  // A parameter of another effect is none of this one.
  EXPECT_THAT(ErrorOf({{"tilt", {{"drag_coefficient", 1}}}}), HasSubstr("'drag_coefficient' does not exist"));
}

TEST(ReadHiddenEffects, ValuesOutOfTheirRangeAreErrors) {
  EXPECT_EQ(ErrorOf({{"drag", {{"drag_coefficient", 2.5}}}}),
            "--effect drag:drag_coefficient=2.5: expected 0 to 2.00 1/m");
  EXPECT_THAT(ErrorOf({{"drag", {{"value", -1}}}}),
              HasSubstr("--effect drag:value=-1: expected 0 to 2.00 1/m"));
  EXPECT_THAT(ErrorOf({{"drag", {{"value", std::nan("")}}}}), HasSubstr("expected 0 to 2.00 1/m"));
  EXPECT_THAT(ErrorOf({{"hum", {{"hum", INFINITY}}}}), HasSubstr("--effect hum:hum=inf: expected"));
}

TEST(ReadHiddenEffects, AParameterThatIsGivenTwiceIsAnError) {
  EXPECT_EQ(ErrorOf({{"drag", {{"value", 1}}}, {"drag", {{"drag_coefficient", 1}}}}),
            "--effect drag: 'drag_coefficient' is given twice");
  EXPECT_EQ(ErrorOf({{"drag", {{"value", 1}, {"drag_coefficient", 1}}}}),
            "--effect drag: 'drag_coefficient' is given twice");
}

TEST(ReadHiddenEffects, EveryProblemRefusesAnEffectWithoutANumber) {
  const std::map<std::string, std::string> effects{{"ankle_on_dynamometer", "axis_offset"},
                                                   {"contact", "tilted_floor"},
                                                   {"drive", "coulomb_friction"},
                                                   {"emg_shape", "fatigue"},
                                                   {"free_body", "air_drag"},
                                                   {"nms", "emg_drift"}};
  for (const ProblemEntry& entry : ProblemRegistry()) {
    ASSERT_EQ(effects.count(entry.name), 1U) << "name an effect of " << entry.name;
    const std::string& effect = effects.at(entry.name);
    SynthesisRequest request;
    request.effects = {{effect, {}}};
    const auto data = entry.synthesize(request);
    ASSERT_FALSE(data) << entry.name;
    EXPECT_EQ(data.error().message.rfind("--effect " + effect + ": expected " + effect + ":", 0), 0U)
        << data.error().message;
  }
}

}  // namespace
}  // namespace sinew
