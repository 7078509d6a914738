#include "problems/kit/parameter_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sinew {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

enum Slot { kMass, kDrag, kLift, kSlots };

ParameterList Made() {
  ParameterList list;
  ParameterListBuilder add(list, kSlots);
  add.Add(BaseParameter("mass", "kg", "of the body", 0, 10, 1), kMass);
  add.BeginEffect("air", Level::kBoundary, "the air pushes", "a drop", "Newton 1687")
      .Positive(kDrag, "drag", "1/m", "deceleration per squared speed", 2)
      .TwoSided(kLift, "lift", "1/m", "acceleration per squared speed", 3)
      .Probes({1, 2});
  add.BeginEffect("gain@fast", Level::kSensor, "the scale reads too much", "a weight", "", "fast");
  add.AddNumber("gain@fast", "1", "reading per weight", 0.5, 2, 1);
  return list;
}

std::string ErrorOf(const ParameterList& list) {
  const Status status = CheckParameterList(list);
  return status ? "" : status.error().message;
}

TEST(ParameterListBuilder, NumbersBelongToTheEffectThatWasBegunLast) {
  const ParameterList list = Made();
  EXPECT_EQ(ErrorOf(list), "");
  ASSERT_EQ(list.effects.size(), 2U);
  EXPECT_THAT(list.effects[0].parameters, ElementsAre(1, 2));
  EXPECT_THAT(list.effects[1].parameters, ElementsAre(3));
  EXPECT_THAT(list.index, ElementsAre(0, 1, 2));
  const Parameter& lift = list.parameters[2];
  EXPECT_EQ(lift.kind, ParameterKind::kEffect);
  EXPECT_EQ(lift.effect, "air");
  EXPECT_EQ(lift.lower, -3);
  EXPECT_EQ(lift.upper, 3);
  EXPECT_EQ(lift.null_value, 0);
  EXPECT_EQ(lift.source, "Newton 1687");
  EXPECT_THAT(lift.probes, ElementsAre(1, 2));
}

TEST(ParameterListBuilder, NumbersOfAnEffectOfOneTrialAreOfThatTrial) {
  const ParameterList list = Made();
  EXPECT_EQ(list.effects[1].trial, "fast");
  EXPECT_EQ(list.parameters[3].trial, "fast");
  EXPECT_EQ(list.parameters[3].null_value, 1);
  EXPECT_EQ(list.parameters[3].source, "");
}

TEST(ParameterListBuilder, SlotsWithoutAParameterAreMarked) {
  ParameterList list;
  ParameterListBuilder add(list, kSlots);
  add.Add(BaseParameter("drag", "1/m", "", 0, 1, 0), kDrag);
  EXPECT_THAT(list.index, ElementsAre(-1, 0, -1));
}

TEST(ParameterListBuilder, ANumberRestsAtItsStartAndHasNoPrior) {
  ParameterList list;
  ParameterListBuilder add(list);
  add.BeginEffect("law", Level::kHuman, "", "");
  Parameter exponent = BaseParameter("exponent", "1", "", -1, 3, 0.5);
  exponent.prior = GaussianPrior{0.5, 0.1};
  add.AddNumber(exponent);
  EXPECT_EQ(list.parameters[0].null_value, 0.5);
  EXPECT_FALSE(list.parameters[0].prior);
}

TEST(ParameterListBuilder, ATermHasAParameterPerKnot) {
  ParameterList list;
  ParameterListBuilder add(list, kSlots);
  add.BeginPort("force", "N", "an unknown force acts");
  add.Term("speed", "m/s", {-1, 1}, -7, 7, "unknown force", kDrag);
  EXPECT_EQ(ErrorOf(list), "");
  const DiscrepancyTerm& term = list.ports.at(0).terms.at(0);
  EXPECT_EQ(term.name, "force(speed)");
  EXPECT_THAT(term.knots, ElementsAre(-1, 1));
  EXPECT_THAT(term.parameters, ElementsAre(0, 1));
  EXPECT_THAT(list.index, ElementsAre(-1, 0, 1));
  EXPECT_EQ(list.parameters[1].name, "force(speed)[1]");
  EXPECT_EQ(list.parameters[1].meaning, "unknown force where speed is knot 1");
  EXPECT_EQ(list.parameters[1].unit, "N");
  EXPECT_EQ(list.parameters[1].lower, -7);
}

TEST(ParameterListBuilder, CopiesAnEffectOfOneNumber) {
  const ParameterList from = Made();
  ParameterList list;
  ParameterListBuilder add(list, kSlots);
  add.Copy(from.effects[1], from.parameters, kLift);
  EXPECT_EQ(ErrorOf(list), "");
  EXPECT_EQ(list.parameters.at(0).name, "gain@fast");
  EXPECT_THAT(list.effects.at(0).parameters, ElementsAre(0));
  EXPECT_THAT(list.index, ElementsAre(-1, -1, 0));
}

TEST(CheckParameterList, NamesWhatIsDeclaredTwice) {
  ParameterList list = Made();
  ParameterListBuilder add(list);
  add.BeginEffect("air", Level::kBoundary, "", "").Positive(ParameterListBuilder::kNoSlot, "x", "1", "", 1);
  EXPECT_EQ(ErrorOf(list), "effect 'air' is declared twice");
  list = Made();
  ParameterListBuilder(list).Add(BaseParameter("drag", "1", "", 0, 1, 0));
  EXPECT_THAT(ErrorOf(list), HasSubstr("'drag'"));
}

TEST(CheckParameterList, NamesAnEffectWithoutNameOrParameter) {
  ParameterList list = Made();
  ParameterListBuilder(list).BeginEffect("empty", Level::kRobot, "", "");
  EXPECT_EQ(ErrorOf(list), "effect 'empty' has no parameter");
  list = Made();
  list.effects[0].name = "";
  EXPECT_EQ(ErrorOf(list), "an effect has no name");
}

TEST(CheckParameterList, NamesBoundsThatExcludeTheNull) {
  ParameterList list = Made();
  list.parameters[1].lower = 0.1;
  EXPECT_THAT(ErrorOf(list), HasSubstr("parameter 'drag'"));
}

TEST(CheckParameterList, NamesAParameterOfAnotherEffect) {
  ParameterList list = Made();
  list.effects[1].parameters = {2};
  EXPECT_EQ(ErrorOf(list), "effect 'gain@fast': its parameter 'lift' is of 'air'");
  list.effects[1].parameters = {9};
  EXPECT_EQ(ErrorOf(list), "effect 'gain@fast': there is no parameter 9");
}

TEST(CheckParameterList, NamesAParameterThatItsEffectDoesNotList) {
  ParameterList list = Made();
  list.effects[0].parameters = {1};
  EXPECT_EQ(ErrorOf(list), "parameter 'lift' is of effect 'air', which does not list it");
}

}  // namespace
}  // namespace sinew
