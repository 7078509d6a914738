#include "datasets/ground_loads.h"

#include <cmath>
#include <limits>

#include "datasets/io/external_loads.h"
#include "datasets/io/force_file.h"
#include "tests/datasets/support.h"

namespace sinew {
namespace {

using testing::HasSubstr;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// A plate whose forces are multiples of `vertical`, at 100 Hz from `begin`.
Trial Step(const std::string& plate, double begin, const std::vector<double>& vertical) {
  Trial trial;
  Grid& grid = trial.grids["plates"];
  for (std::size_t i = 0; i < vertical.size(); ++i)
    grid.time.push_back(begin + 0.01 * static_cast<double>(i));
  const auto add = [&](const std::string& kind, double factor, const std::string& unit) {
    Channel& channel = grid.channels[plate + "_" + kind];
    channel.unit = unit;
    for (const double v : vertical) channel.values.push_back(factor * v);
  };
  add("force_x", 0.1, "N");
  add("force_y", 1, "N");
  add("force_z", -0.05, "N");
  add("cop_x", 0.001, "m");
  add("cop_z", 0.0002, "m");
  add("moment_y", 0.01, "N*m");
  return trial;
}

TEST(GroundLoads, TheFirstTrialWithALoadCountsAndZeroWhereNoneHasOne) {
  const Trial recording = Step("left", 0, {0, 400, 500, 0, 0, 0, 0, 0});
  const Trial predicted = Step("left", 0.04, {300, 600, 200});
  const Trial other = Step("right", 0.09, {100, 200});
  const auto loads = JoinGroundLoads(
      {{"recording", "walk", &recording}, {"predicted", "walk", &predicted}, {"other", "walk", &other}}, 0);
  ASSERT_TRUE(loads) << ErrorOf(loads);
  ASSERT_EQ(loads->time.size(), 11U);
  EXPECT_NEAR(loads->time.back(), 0.1, 1e-12);
  ASSERT_EQ(loads->plates.size(), 2U);
  const std::vector<double> left{0, 400, 500, 0, 300, 600, 200, 0, 0, 0, 0};
  for (std::size_t i = 0; i < left.size(); ++i)
    EXPECT_NEAR(loads->plates[0].values[1][i], left[i], 1e-6) << i;
  EXPECT_NEAR(loads->plates[0].values[3][5], 0.6, 1e-9);  // centre of pressure
  EXPECT_NEAR(loads->plates[0].values[7][2], 5, 1e-9);    // free moment
  EXPECT_EQ(loads->plates[0].values[6][2], 0);            // which no trial has
  EXPECT_NEAR(loads->plates[1].values[1][8], 0, 1e-12);
  EXPECT_NEAR(loads->plates[1].values[1][10], 200, 1e-6);
  ASSERT_EQ(loads->spans.size(), 3U);
  EXPECT_EQ(loads->spans[1].source, "predicted");
  EXPECT_NEAR(loads->spans[1].from, 0.04, 1e-9);
  EXPECT_NEAR(loads->spans[1].to, 0.06, 1e-9);
}

TEST(GroundLoads, ValuesBetweenSamplesAreInterpolated) {
  const Trial step = Step("left", 0.5, {100, 200, 400});
  const auto loads = JoinGroundLoads({{"step", "walk", &step}}, 200);
  ASSERT_TRUE(loads) << ErrorOf(loads);
  const std::vector<double> expected{100, 150, 200, 300, 400};
  ASSERT_EQ(loads->time.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(loads->plates[0].values[1][i], expected[i], 1e-6);
}

TEST(GroundLoads, UnknownCentresOfPressureAreThoseOfTheNearestKnownInstant) {
  Trial step = Step("left", 0, {10, 100, 200, 300, 20});
  step.grids["plates"].channels["left_cop_x"].values = {kUnknown, 0.3, kUnknown, 0.5, kUnknown};
  const auto loads = JoinGroundLoads({{"step", "walk", &step}}, 0);
  ASSERT_TRUE(loads) << ErrorOf(loads);
  const std::vector<double> expected{0.3, 0.3, 0.3, 0.5, 0.5};
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(loads->plates[0].values[3][i], expected[i], 1e-9) << i;
}

TEST(GroundLoads, AForceThatIsMissingWithinATrialIsAGap) {
  Trial step = Step("left", 0, {100, 200, 300, 200, 100});
  const auto whole = JoinGroundLoads({{"step", "walk", &step}}, 0);
  ASSERT_TRUE(whole) << ErrorOf(whole);
  EXPECT_TRUE(whole->gaps.empty());
  step.grids["plates"].channels["left_force_y"].values[2] = kUnknown;
  const auto loads = JoinGroundLoads({{"step", "walk", &step}}, 0);
  ASSERT_TRUE(loads) << ErrorOf(loads);
  EXPECT_EQ(loads->plates[0].values[1][2], 0);
  ASSERT_EQ(loads->gaps.size(), 1U);
  EXPECT_NEAR(loads->gaps[0].from, 0.02, 1e-9);
  EXPECT_NEAR(loads->gaps[0].to, 0.02, 1e-9);
  EXPECT_EQ(loads->spans.size(), 2U);
  const Trial predicted = Step("left", 0, {90, 190, 290, 190, 90});
  const auto filled = JoinGroundLoads({{"step", "walk", &step}, {"predicted", "walk", &predicted}}, 0);
  ASSERT_TRUE(filled) << ErrorOf(filled);
  EXPECT_TRUE(filled->gaps.empty());
  EXPECT_NEAR(filled->plates[0].values[1][2], 290, 1e-9);
}

TEST(GroundLoads, ATrialWithoutValuesHoldsNoLoad) {
  Trial unmeasured = Step("left", 0, {1, 2});
  for (auto& [name, channel] : unmeasured.grids["plates"].channels) channel.values.assign(2, kUnknown);
  EXPECT_FALSE(HoldsLoad(unmeasured));
  EXPECT_THAT(ErrorOf(JoinGroundLoads({{"step", "walk", &unmeasured}}, 0)), HasSubstr("no trial has values"));
  EXPECT_TRUE(HoldsLoad(Step("left", 0, {1, 2})));
}

TEST(GroundLoads, WhatCannotBeWrittenIsOneError) {
  Trial step = Step("left", 0, {100, 200});
  EXPECT_THAT(ErrorOf(JoinGroundLoads({{"step", "walk", &step}}, 1e12)), HasSubstr("expected at most 2e+07"));
  EXPECT_THAT(ErrorOf(JoinGroundLoads({{"step", "walk", &step}, {"other", "free", &step}}, 0)),
              HasSubstr("of two recordings ('walk', 'free')"));
  step.grids["plates"].channels["left_cop_z"].values.assign(2, kUnknown);
  EXPECT_THAT(ErrorOf(JoinGroundLoads({{"step", "walk", &step}}, 0)), HasSubstr("left_cop_z has no values"));
  step.grids["plates"].channels.erase("left_cop_z");
  EXPECT_THAT(ErrorOf(JoinGroundLoads({{"step", "walk", &step}}, 0)),
              HasSubstr("trial 'step': has left_force_y without left_cop_z"));
}

TEST(ForceFile, IsReadAsItWasWritten) {
  const Trial step = Step("left", 0, {100, 200, 300});
  const auto loads = JoinGroundLoads({{"step", "walk", &step}}, 0);
  ASSERT_TRUE(loads) << ErrorOf(loads);
  const Storage table = ForceTable(*loads);
  ASSERT_EQ(table.names.size(), 9U);
  ASSERT_NE(table.Find("left_ground_force_vy"), nullptr);
  EXPECT_EQ(*table.Find("left_ground_force_vy"), loads->plates[0].values[1]);
  EXPECT_EQ(*table.Find("left_ground_force_pz"), loads->plates[0].values[5]);
  EXPECT_EQ(*table.Find("left_ground_torque_y"), loads->plates[0].values[7]);

  const auto read = ParseExternalLoads(
      ExternalLoadsText({ForceOn("left", "calcn_l"), ForceOn("a<b&c", "calcn_r")}, "grf.mot"), "x.xml");
  ASSERT_TRUE(read) << ErrorOf(read);
  ASSERT_EQ(read->size(), 2U);
  EXPECT_EQ((*read)[0].name, "left");
  EXPECT_EQ((*read)[0].applied_to_body, "calcn_l");
  EXPECT_EQ((*read)[0].force_identifier, "left_ground_force_v");
  EXPECT_EQ((*read)[1].name, "a<b&c");
}

}  // namespace
}  // namespace sinew
