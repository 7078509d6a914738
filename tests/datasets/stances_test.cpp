// Stances found on plates whose loads are known.
#include "datasets/stances/stances.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "datasets/stances/stance_trials.h"

namespace sinew {
namespace {

struct Step {
  double from;
  double to;
  double cop_x = 0;
  double peak = 800;
};

constexpr double kRate_Hz = 1000;

// A plate's force (two humps), level and noise, with the centre of pressure from heel to toe.
void AddPlate(Trial& trial, const std::string& plate, const std::vector<Step>& steps, double level,
              double noise, double end = 6) {
  std::mt19937 random(static_cast<unsigned>(plate.size()));
  std::normal_distribution<double> normal;
  Grid& grid = trial.grids["forces"];
  grid.time.clear();
  Channel force{"N", ChannelKind::kMeasured, {}, {}};
  Channel x{"m", ChannelKind::kMeasured, {}, {}};
  Channel z{"m", ChannelKind::kMeasured, {}, {}};
  for (int i = 0; i < end * kRate_Hz; ++i) {
    const double t = i / kRate_Hz;
    double f = 0;
    double cop = 0;
    for (const Step& step : steps) {
      const double p = (t - step.from) / (step.to - step.from);
      if (p < 0 || p > 1) continue;
      f += step.peak * (std::sin(M_PI * p) + 0.25 * std::sin(3 * M_PI * p));
      cop = step.cop_x + 0.2 * p;
    }
    grid.time.push_back(t);
    force.values.push_back(f + level + noise * normal(random));
    x.values.push_back(cop);
    z.values.push_back(0.1);
  }
  grid.channels[plate + "_force_y"] = force;
  grid.channels[plate + "_cop_x"] = x;
  grid.channels[plate + "_cop_z"] = z;
}

std::vector<Contact> Whole(const TrialContacts& contacts) {
  std::vector<Contact> whole;
  for (const Contact& contact : contacts.contacts) {
    if (contact.fault == ContactFault::kNone) whole.push_back(contact);
  }
  return whole;
}

TEST(Stances, AreFoundDespiteOffsetAndNoiseOfThePlate) {
  for (const double level : {0.0, 30.0, -30.0}) {
    for (const double noise : {0.0, 1.0, 5.0}) {
      Trial trial;
      AddPlate(trial, "right", {{0.5, 1.2}, {1.6, 2.3}, {2.7, 3.4}}, level, noise);
      AddPlate(trial, "left", {{1.05, 1.75}, {2.15, 2.85}}, level, noise);
      const auto whole = Whole(FindContacts(trial));
      ASSERT_EQ(whole.size(), 5U) << level << " " << noise;
      EXPECT_EQ(whole[0].plate, "right");
      EXPECT_EQ(whole[1].plate, "left");
      // Off threshold of 5 N noise is 15 N, of a load that rises with 6 kN/s: 3 ms; noise may cross it
      // before.
      EXPECT_NEAR(whole[0].from, 0.5, 0.012);
      EXPECT_NEAR(whole[0].to, 1.2, 0.012);
      EXPECT_NEAR(whole[0].double_support_s, 0.15, 0.02);
    }
  }
}

TEST(Stances, PartialLightAndShortContactsAreLeftOutAndNamed) {
  Trial trial;
  AddPlate(trial, "right", {{-0.3, 0.4}, {1, 1.7}, {2.2, 2.9}, {3.3, 4, 0, 80}, {4.4, 4.45}, {5.5, 6.2}}, 0,
           1);
  std::vector<std::string> faults;
  for (const Contact& contact : FindContacts(trial).contacts) faults.emplace_back(ToString(contact.fault));
  EXPECT_THAT(faults, testing::ElementsAre("began", "", "", "light", "short", "ends"));
}

TEST(Stances, ASecondFootOnThePlateIsLeftOut) {
  Trial trial;
  AddPlate(trial, "plate", {{0.5, 1.2, 0.1}, {2, 2.7, 0.1}, {2.5, 3.2, 0.8}, {4, 4.7, 0.1}}, 0, 0);
  std::vector<std::string> faults;
  for (const Contact& contact : FindContacts(trial).contacts) faults.emplace_back(ToString(contact.fault));
  EXPECT_THAT(faults, testing::ElementsAre("", "two_feet", ""));
}

TEST(Stances, TwoPlatesUnderOneNameAreSaid) {
  Trial trial;
  AddPlate(trial, "right", {{0.5, 1.2, 0.1}, {2, 2.7, 1.5}}, 0, 0);
  const TrialContacts contacts = FindContacts(trial);
  EXPECT_EQ(Whole(contacts).size(), 2U);
  EXPECT_EQ(contacts.plates[0].places, 2);
}

TEST(Stances, APlateThatIsNeverUnloadedSaysNothing) {
  Trial trial;
  AddPlate(trial, "right", {{0.5, 1.2}}, 0, 0);
  for (double& v : trial.grids["forces"].channels["right_force_y"].values) v = 600;
  const TrialContacts contacts = FindContacts(trial);
  EXPECT_TRUE(contacts.contacts.empty());
  EXPECT_FALSE(contacts.plates[0].seen);
}

TEST(Stances, TrialsKeepTheirPlateAndEveryThirdIsHeldOut) {
  Dataset data;
  Trial& trial = data.trials["walk"];
  AddPlate(trial, "right", {{0.5, 1.2}, {1.6, 2.3}}, 0, 0);
  AddPlate(trial, "left", {{1.05, 1.75}}, 0, 0);
  const auto stances = PlanStances("walk", FindContacts(trial), 3);
  ASSERT_EQ(stances.size(), 3U);
  ASSERT_TRUE(CutStances(data, "walk", stances));
  EXPECT_EQ(data.trials.at("walk_right_1").role, Role::kTrain);
  EXPECT_EQ(data.trials.at("walk_left_1").role, Role::kTrain);
  EXPECT_EQ(data.trials.at("walk_right_2").role, Role::kValidate);
  EXPECT_TRUE(data.trials.at("walk_left_1").Find("left_force_y"));
  EXPECT_FALSE(data.trials.at("walk_left_1").Find("right_force_y"));
  EXPECT_FALSE(CutStances(data, "walk", stances)) << "the names are taken";
}

}  // namespace
}  // namespace sinew
