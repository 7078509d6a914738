#include "problems/ankle_on_dynamometer/problem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/random.h"
#include "tests/problems/ankle_on_dynamometer/ankle_bench.h"
#include "tests/problems/support/jacobian_check.h"

namespace sinew {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::UnorderedElementsAre;

std::set<std::string> NamesOf(const Problem& problem, const std::vector<int>& indices) {
  std::set<std::string> names;
  for (const int index : indices) names.insert(problem.parameters()[static_cast<std::size_t>(index)].name);
  return names;
}

std::vector<std::string> StepNames(const Problem& problem) {
  std::vector<std::string> names;
  for (const FitStep& step : problem.steps()) names.push_back(step.name);
  return names;
}

TEST(AnkleProblemTest, AttachmentAloneDependsOnTheRobotOnly) {
  const auto problem = BindAnkleBench();
  EXPECT_THAT(NamesOf(*problem, BlockOf(*problem, "alone", "machine_torque").columns),
              UnorderedElementsAre("attachment_inertia", "attachment_gravity", "attachment_gravity_angle",
                                   "attachment_friction", "dry_friction", "directional_friction",
                                   "friction_with_load", "attachment_stiffness"));
  // And what it does not declare does not change it.
  const Vector rest = RestPoint(*problem);
  Random random(1);
  Vector other = RandomInside(*problem, 0.3, random);
  const auto& columns = BlockOf(*problem, "alone", "machine_torque").columns;
  for (const int index : columns) other[index] = rest[index];
  const auto predict = [&](const Vector& at) {
    Prediction prediction(problem->layout());
    const auto workspace = problem->NewWorkspace();
    std::vector<bool> wanted(problem->layout().size(), false);
    wanted[0] = true;
    EXPECT_TRUE(problem->Predict({at, wanted, false, nullptr}, *workspace, prediction));
    return Vector(prediction.values(0));
  };
  EXPECT_EQ(problem->layout()[0].trial, "alone");
  EXPECT_EQ(predict(other), predict(rest));
}

TEST(AnkleProblemTest, PassiveTrialsDoNotDependOnTheDrive) {
  const auto problem = BindAnkleBench();
  const auto relaxed = NamesOf(*problem, BlockOf(*problem, "relaxed", "machine_torque").columns);
  const auto working = NamesOf(*problem, BlockOf(*problem, "working", "machine_torque").columns);
  for (const char* name :
       {"shape", "filter_time", "delay", "fatigue", "unseen_drive", "emg_crosstalk", "antagonist"}) {
    EXPECT_EQ(relaxed.count(name), 0U) << name;
    EXPECT_EQ(working.count(name), 1U) << name;
  }
  for (const char* name :
       {"passive_stiffness", "strap_stiffness", "tendon_slack_length.triceps", "axis_offset_x"})
    EXPECT_EQ(relaxed.count(name), 1U) << name;
}

TEST(AnkleProblemTest, StepsGoFromTheAttachmentToAllLevels) {
  const auto problem = BindAnkleBench();
  EXPECT_THAT(StepNames(*problem), ElementsAre("attachment alone", "passive", "active", "all levels"));
  const auto& steps = problem->steps();
  EXPECT_THAT(NamesOf(*problem, steps[0].parameters),
              UnorderedElementsAre("attachment_inertia", "attachment_gravity", "attachment_gravity_angle",
                                   "attachment_friction"));
  EXPECT_THAT(NamesOf(*problem, steps[1].parameters),
              UnorderedElementsAre("sole_stiffness", "sole_friction", "strap_stiffness", "strap_exponent",
                                   "strap_pretension", "passive_stiffness", "passive_exponent",
                                   "passive_linear_stiffness", "passive_damping",
                                   "tendon_slack_length.triceps", "tendon_slack_length.tib_ant_r"));
  EXPECT_THAT(NamesOf(*problem, steps[2].parameters),
              UnorderedElementsAre("shape", "filter_time", "delay", "strength.triceps", "strength.tib_ant_r",
                                   "tendon_slack_length.triceps", "tendon_slack_length.tib_ant_r"));
  EXPECT_EQ(steps[3].parameters.size(), 20U);
  EXPECT_EQ(steps[3].blocks.size(), 5U);
  const char* trials[] = {"alone", "relaxed", "working"};
  for (std::size_t s = 0; s < 3; ++s) {
    EXPECT_FALSE(steps[s].blocks.empty());
    for (const int b : steps[s].blocks)
      EXPECT_EQ(problem->layout()[static_cast<std::size_t>(b)].trial, trials[s]);
  }
}

TEST(AnkleProblemTest, StepsWithoutATrainingTrialAreLeftOut) {
  Dataset data = AnkleBenchData();
  data.trials["relaxed"].role = Role::kValidate;
  EXPECT_THAT(StepNames(*BindAnkleBench(data)), ElementsAre("attachment alone", "active", "all levels"));
  data.trials.erase("alone");
  EXPECT_THAT(StepNames(*BindAnkleBench(data)), ElementsAre("active", "all levels"));
}

TEST(AnkleProblemTest, EveryTrialMayHaveAZeroOfItsTorque) {
  AnkleSettings settings = AnkleBenchSettings();
  settings.torque_zero = 0.5;
  const auto with = BindAnkleBench(AnkleBenchData(), settings);
  const auto without = BindAnkleBench();
  ASSERT_EQ(with->parameters().size(), without->parameters().size() + 3);
  const auto index = FindParameter(with->parameters(), "torque_zero@working");
  ASSERT_TRUE(index) << index.error().message;
  const Parameter& zero = with->parameters()[static_cast<std::size_t>(*index)];
  EXPECT_EQ(zero.kind, ParameterKind::kNuisance);
  EXPECT_EQ(zero.trial, "working");
  EXPECT_EQ(zero.unit, "N*m");
  EXPECT_EQ(zero.prior->mean, 0);
  EXPECT_EQ(zero.prior->standard_deviation, 0.5);
  Vector point = RestPoint(*with);
  const Prediction rest = PredictAnkle(*with, point);
  point[*index] = 1.5;
  const Prediction moved = PredictAnkle(*with, point);
  for (std::size_t b = 0; b < with->layout().size(); ++b) {
    const Block& block = with->layout()[b];
    const int at = static_cast<int>(b);
    const double expected = block.trial == "working" && block.channel == "machine_torque" ? 1.5 : 0;
    EXPECT_LT((moved.values(at) - rest.values(at) - Vector::Constant(block.predictions(), expected)).norm(),
              1e-9);
    EXPECT_EQ(std::count(block.columns.begin(), block.columns.end(), *index), expected != 0 ? 1 : 0);
  }
}

// When the tibialis pulls, straps alone hold the foot on the plate.
TEST(AnkleProblemTest, SoftStrapsLetTheFootLiftOff) {
  const auto problem = BindAnkleBench();
  Vector point = RestPoint(*problem);
  point[*FindParameter(problem->parameters(), "strength.tib_ant_r")] = 4;
  const auto lift = [&](double stiffness) {
    point[*FindParameter(problem->parameters(), "strap_stiffness")] = stiffness;
    const Prediction prediction = PredictAnkle(*problem, point);
    const Block& block = BlockOf(*problem, "working", "ankle_angle");
    const auto b = static_cast<int>(&block - problem->layout().data());
    double largest = 0;
    for (int i = 0; i < block.predictions(); ++i) {
      const double plate = -0.1 + 0.3 * std::cos(5 * block.prediction_time[static_cast<std::size_t>(i)]);
      largest = std::max(largest, prediction.values(b)[i] - plate);
    }
    return largest;
  };
  EXPECT_LT(lift(1e5), 0.05);
  EXPECT_GT(lift(1e3), 2 * lift(1e5));
}

TEST(AnkleProblemTest, JacobianAgrees) {
  AnkleSettings settings = AnkleBenchSettings();
  settings.torque_zero = 0.5;
  settings.rate = 20;
  settings.foot.strips = 3;
  const auto problem = BindAnkleBench(AnkleBenchData(), settings);
  Random random(2);
  int compared = 0;
  int columns = 0;
  for (int i = 0; i < 2; ++i) {
    // Near the usual values, with a little of every effect.
    Vector point = RestPoint(*problem);
    point += 0.05 * (RandomInside(*problem, 0.05, random) - point);
    const JacobianCheck check = CheckJacobian(*problem, point);
    EXPECT_LT(check.worst, 1e-5);
    compared += check.compared;
    columns += check.columns;
  }
  // The sole touches and lets go strip by strip, and excitations have corners at their samples.
  EXPECT_GE(compared, columns / 2);
}

// Anywhere within the bounds, effects included: numbers, or a sentence that says when and where.
TEST(AnkleProblemTest, RandomParametersEndOrFailWithASentence) {
  const auto problem = BindAnkleBench();
  const auto workspace = problem->NewWorkspace();
  const std::vector<bool> all(problem->layout().size(), true);
  Random random(3);
  int ended = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vector point = RandomInside(*problem, 0, random);
    Prediction prediction(problem->layout());
    const Status status = problem->Predict({point, all, i % 10 == 0, nullptr}, *workspace, prediction);
    if (!status) {
      EXPECT_THAT(status.error().message, testing::MatchesRegex("trial '(relaxed|working)': t = .* s: .+"));
      continue;
    }
    ++ended;
    for (std::size_t b = 0; b < problem->layout().size(); ++b) {
      ASSERT_TRUE(prediction.values(static_cast<int>(b)).allFinite()) << i;
      if (i % 10 == 0) {
        ASSERT_TRUE(prediction.derivatives(static_cast<int>(b)).allFinite()) << i;
      }
    }
  }
  RecordProperty("ended", ended);
  EXPECT_GE(ended, 750);
}

// A workspace keeps the last run of every trial: whatever was asked before, the answer is the same.
TEST(AnkleProblemTest, PredictionsDoNotDependOnTheOnesBefore) {
  const auto problem = BindAnkleBench();
  const std::vector<bool> all(problem->layout().size(), true);
  const Vector rest = RestPoint(*problem);
  const auto used = problem->NewWorkspace();
  for (const char* name :
       {"attachment_gravity", "passive_stiffness", "delay", "strength.triceps", "dry_friction"}) {
    Vector point = rest;
    point[*FindParameter(problem->parameters(), name)] *= 1.1;
    point[*FindParameter(problem->parameters(), name)] += 0.01;
    for (const Vector& at : {rest, point}) {
      Prediction again(problem->layout());
      Prediction fresh(problem->layout());
      ASSERT_TRUE(problem->Predict({at, all, false, nullptr}, *used, again));
      ASSERT_TRUE(problem->Predict({at, all, true, nullptr}, *used, again));
      ASSERT_TRUE(problem->Predict({at, all, true, nullptr}, *problem->NewWorkspace(), fresh));
      for (std::size_t b = 0; b < problem->layout().size(); ++b) {
        const int block = static_cast<int>(b);
        EXPECT_TRUE((again.values(block).array() == fresh.values(block).array()).all()) << name;
        EXPECT_TRUE((again.derivatives(block).array() == fresh.derivatives(block).array()).all()) << name;
      }
    }
  }
}

// Measured torque less attachment, passive ankle and weight of the foot, and its slopes.
TEST(AnkleProblemTest, TheInverseViewIsWhatIsLeftForTheMuscles) {
  const auto problem = BindAnkleBench();
  const Vector rest = RestPoint(*problem);
  const auto inverse = [&](const Vector& at) {
    Hdf5Node details;
    EXPECT_TRUE(problem->WriteDetails(at, details));
    return details.At("ankle_on_dynamometer/working");
  };
  Hdf5Node node = inverse(rest);
  const auto read = [&](const char* name) { return node.At(name).array()->values; };
  const auto left = read("inverse/torque_of_muscles");
  const auto attachment = read("torque_of_attachment");
  const auto passive = read("moment_passive");
  const auto angle = read("ankle_angle");
  const Block& block = BlockOf(*problem, "working", "machine_torque");
  ASSERT_EQ(left.size(), block.measured.size());
  for (std::size_t i = 0; i < left.size(); ++i) {
    const double weight = WeightOfFoot(problem->data().settings.foot, angle[i]);
    EXPECT_NEAR(left[i], block.measured[i] - attachment[i] - passive[i] - weight, 1e-9);
  }
  const std::vector<std::string>& names = *node.At("inverse/parameters").texts();
  const auto slopes = read("inverse/slopes");
  ASSERT_EQ(slopes.size(), left.size() * names.size());
  for (std::size_t k = 0; k < names.size(); ++k) {
    const int index = *FindParameter(problem->parameters(), names[k]);
    const double h = 1e-6 * std::max(std::abs(rest[index]), 0.1);
    Vector above = rest;
    Vector below = rest;
    above[index] += h;
    below[index] -= h;
    const auto high = inverse(above).At("inverse/torque_of_muscles").array()->values;
    const auto low = inverse(below).At("inverse/torque_of_muscles").array()->values;
    double off = 0;
    double size = 0;
    for (std::size_t i = 0; i < left.size(); ++i) {
      const double expected = (high[i] - low[i]) / (2 * h);
      off = std::max(off, std::abs(slopes[i * names.size() + k] - expected));
      size = std::max(size, std::abs(expected));
    }
    EXPECT_LE(off, 1e-3 * size + 1e-7) << names[k];
  }
}

TEST(AnkleProblemTest, DetailsAddUp) {
  const auto problem = BindAnkleBench();
  Hdf5Node details;
  ASSERT_TRUE(problem->WriteDetails(RestPoint(*problem), details));
  const auto read = [&](const char* name) {
    return details.At("ankle_on_dynamometer/working").At(name).array()->values;
  };
  const auto torque = read("machine_torque");
  const auto interaction = read("interaction_torque");
  const auto attachment = read("torque_of_attachment");
  const auto sole = read("torque_of_sole");
  const auto straps = read("torque_of_straps");
  ASSERT_EQ(torque.size(), 101U);
  for (std::size_t i = 0; i < torque.size(); ++i) {
    EXPECT_NEAR(torque[i], interaction[i] + attachment[i], 1e-9);
    EXPECT_NEAR(interaction[i], sole[i] + straps[i], 1e-9);
  }
}

}  // namespace
}  // namespace sinew
