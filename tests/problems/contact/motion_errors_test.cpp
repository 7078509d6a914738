#include "problems/contact/motion/motion_errors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "problems/contact/load/posed_load.h"
#include "tests/problems/support/jacobian_check.h"
#include "tests/problems/support/stepping_data.h"
#include "tests/support/allocation_counter.h"

namespace sinew {
namespace {

using testing::HasSubstr;

const char* const kFitsAll = "fit: [force_x, force_y, force_z, cop_x, cop_z, moment_y]";

// The robot's contact.yaml with more keys and all channels of the force.
std::string Moving(const std::string& keys) {
  std::string text = SettingsText(ExactData(), kFitsVertical, std::string(kFitsForce) + "\n  " + keys);
  const std::string objective = "objective: thesis";
  text.replace(text.find(objective), objective.size(), "objective: likelihood\n  accuracy: {force: 1}");
  return text;
}
const char* const kErrors =
    "motion_errors: {position: 0.0001, rotation: 0.001, correlation_time: 0.2, cutoff: 3}";

const Dataset& OneStance() {
  static const Dataset kData = SteppingData({{"fine", 0}, {"train", 1}, {"validate", 0}}, 0);
  return kData;
}

Dataset WithoutMarkers(Dataset data) {
  for (auto& [name, trial] : data.trials) trial.grids.erase("markers");
  return data;
}

TEST(MotionErrors, WithoutDeviationTheFootIsWhereItWasRecorded) {
  // A cutoff above half the frame rate: nothing is smoothed; no marker moves the foot, and one stance has
  // nothing to be levelled to.
  const Dataset data = WithoutMarkers(OneStance());
  const auto still = MakeContact(data, SettingsText(data, kFitsVertical, kFitsForce)).value();
  const auto moving = MakeContact(data, Moving("motion_errors: {cutoff: 40}")).value();
  Vector truth = RestPoint(*moving);
  truth.head(5) = TruthOf(*still).head(5);
  const Prediction expected = PredictEverything(*still, TruthOf(*still));
  const Prediction found = PredictEverything(*moving, truth);
  int compared = 0;
  for (std::size_t s = 0; s < still->data().stances.size(); ++s) {
    const Stance& a = still->data().stances[s];
    const Stance& b = moving->data().stances[s];
    for (std::size_t c = 0; c < a.blocks.size(); ++c) {
      for (std::size_t i = 0; i < b.time.size(); ++i) {
        // The plate of this robot samples with the motion.
        const auto at = std::find_if(a.time.begin(), a.time.end(),
                                     [&](double t) { return std::abs(t - b.time[i]) < 1e-9; });
        if (at == a.time.end()) continue;
        const double value = expected.values(a.blocks[c])[at - a.time.begin()];
        EXPECT_NEAR(found.values(b.blocks[c])[static_cast<Eigen::Index>(i)], value,
                    1e-8 * (1 + std::abs(value)));
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 100);
}

TEST(MotionErrors, WhatStancesHaveInCommonIsMirroredForTheOtherFoot) {
  const auto directions = FootDirections(Vec3(0.6, 0, 0.8), 1);
  const auto mirrored = FootDirections(Vec3(0.6, 0, 0.8), -1);
  const auto kept = [&](int c) {
    return directions[static_cast<std::size_t>(c)] == mirrored[static_cast<std::size_t>(c)];
  };
  const auto turned = [&](int c) {
    return directions[static_cast<std::size_t>(c)] == -mirrored[static_cast<std::size_t>(c)];
  };
  for (const int c : {kShiftX, kShiftY, kTurnZ, kJointAngle}) EXPECT_TRUE(kept(c)) << c;
  for (const int c : {kShiftZ, kTurnX, kTurnY}) EXPECT_TRUE(turned(c)) << c;
  EXPECT_EQ(directions[kShiftX].head<3>(), Vec3(0.6, 0, 0.8));
  EXPECT_EQ(directions[kShiftZ].head<3>(), Vec3(-0.8, 0, 0.6));
}

// The recorded motion slides and sways by centimetres while the markers on the foot do not.
TEST(MotionErrors, TheMarkersOfAFootMoveItBack) {
  Dataset data = ExactData();
  for (auto& [name, trial] : data.trials) {
    Grid& grid = trial.grids.at("coordinates");
    for (const char* coordinate : {"pelvis_tx", "pelvis_tz"}) {
      std::vector<double>& values = grid.channels.at(coordinate).values;
      for (std::size_t i = 0; i < values.size(); ++i) values[i] += 0.02 * std::sin(6 * grid.time[i]);
    }
  }
  const auto problem = MakeContact(data, Moving("motion_errors: {cutoff: 12}")).value();
  const auto exact = MakeContact(ExactData(), Moving("motion_errors: {cutoff: 12}")).value();
  const Stance& stance = problem->data().stances.front();
  const Stance& expected = exact->data().stances.front();
  double worst = 0;
  for (std::size_t t = 5; t + 5 < stance.time.size(); ++t)
    worst = std::max(worst, (stance.foot.centre_velocity[t] - expected.foot.centre_velocity[t]).norm());
  EXPECT_LT(worst, 0.02);  // of 0.12 m/s that were added
}

TEST(MotionErrors, FlatFeetAreLevelled) {
  constexpr double kRaised = 0.01;
  Dataset data = ExactData();
  Trial& trial = data.trials.at("validate_1");
  for (const char* grid : {"coordinates", "markers"}) {
    for (auto& [name, channel] : trial.grids.at(grid).channels) {
      const bool vertical = name == "pelvis_ty" || (name.size() > 2 && name.substr(name.size() - 2) == "_y" &&
                                                    std::string(grid) == "markers");
      if (!vertical) continue;
      for (double& value : channel.values) value += kRaised;
    }
  }
  const auto level = MakeContact(ExactData(), Moving("motion_errors: {}")).value();
  const auto raised = MakeContact(data, Moving("motion_errors: {}")).value();
  for (std::size_t s = 0; s < level->data().stances.size(); ++s) {
    const Stance& expected = level->data().stances[s];
    const Stance& found = raised->data().stances[s];
    for (std::size_t t = 0; t < expected.time.size(); ++t)
      EXPECT_NEAR(found.foot.centre[t].y(), expected.foot.centre[t].y(), 1e-5) << expected.trial;
  }
  EXPECT_THAT(raised->data().notes, testing::Contains(HasSubstr("'validate_1'")));
  EXPECT_THAT(raised->data().notes, testing::Contains(HasSubstr("was lowered by")));
}

TEST(MotionErrors, AFloorThatMovesHasAVelocityOfItsOwn) {
  const std::string moving = "floor_velocity: [0.002, 0]\n  ";
  const auto problem = MakeContact(OneStance(), Moving(moving + kErrors)).value();
  const auto still = MakeContact(OneStance(), Moving(kErrors)).value();
  const std::vector<Parameter>& list = problem->parameters();
  const auto found =
      std::find_if(list.begin(), list.end(), [](const Parameter& p) { return p.name == "floor_velocity_x"; });
  ASSERT_NE(found, list.end());
  EXPECT_EQ(found->kind, ParameterKind::kNuisance);
  EXPECT_EQ(found->prior->standard_deviation, kStandingFoot);
  EXPECT_EQ(list.size(), still->parameters().size() + 1) << "along z it does not move";

  // What is stated and taken away again is no motion.
  Vector at_rest = RestPoint(*problem);
  at_rest[found - list.begin()] = -0.002;
  const Prediction moved = PredictEverything(*problem, at_rest);
  const Prediction expected = PredictEverything(*still, RestPoint(*still));
  for (const int block : problem->data().stances.front().blocks)
    EXPECT_LT((moved.values(block) - expected.values(block)).norm(),
              1e-9 * (1 + expected.values(block).norm()));

  // Within a millimetre per second few springs begin to slide between two differences.
  const auto known =
      MakeContact(OneStance(), Moving(moving + "floor_velocity_error: [0.0001, 0]\n  " + kErrors)).value();
  Random random(4);
  ExpectJacobianAgrees(*known, random, kSoleWithMemory);
}

TEST(MotionErrors, AFloorWhoseVelocityIsExactHasNoParameter) {
  const auto problem =
      MakeContact(
          OneStance(),
          Moving(std::string("floor_velocity: [0.02, 0]\n  floor_velocity_error: [0, 0.001]\n  ") + kErrors))
          .value();
  const std::vector<Parameter>& list = problem->parameters();
  const auto has = [&](const char* name) {
    return std::any_of(list.begin(), list.end(), [&](const Parameter& p) { return p.name == name; });
  };
  EXPECT_FALSE(has("floor_velocity_x"));
  EXPECT_TRUE(has("floor_velocity_z"));
}

TEST(MotionErrors, JacobianAgreesWithDifferences) {
  const std::string places =
      "    sole_height: {lower: -0.0003, upper: 0.0003}\n    sole_forward: {lower: -0.001, upper: 0.001}\n";
  const auto problem = MakeContact(OneStance(), Moving(kErrors) + places).value();
  ASSERT_GT(problem->parameters().size(), 60U);
  Random random(1);
  ExpectJacobianAgrees(*problem, random, kSoleWithMemory);
}

// Without effects the load and its derivatives come in one pass; with effects, at their null too, spring by
// spring.
TEST(MotionErrors, OnePassOverTheSpringsIsWhatTheyAddUpTo) {
  constexpr double kRounding = 1e-10;  // of sums of products of up to a thousand terms
  const auto problem =
      MakeContact(ExactData(), Moving(kErrors) + "    sole_height: {lower: -0.0003, upper: 0.0003}\n")
          .value();
  const Stance& stance = problem->data().stances.front();
  PosedFoot posed(stance.kinematics);
  EffectLoad once;
  EffectLoad summed;
  for (EffectLoad* load : {&once, &summed}) load->by_part.resize(stance.parts.size());
  for (const FootMotion::Springs& springs : stance.foot.springs)
    summed.by_spring.emplace_back(springs.position.size());
  ContactPoseJacobian once_by_pose;
  ContactPoseJacobian by_pose;
  std::vector<ContactPlaceJacobian> once_by_place(stance.parts.size());
  std::vector<ContactPlaceJacobian> by_place(stance.parts.size());
  Random random(3);
  int touching = 0;
  for (int round = 0; round < 50; ++round) {
    const Vector parameters = RandomInside(*problem, 0.02, random);
    const std::vector<ElasticFoundation> beds(stance.parts.size(), ContactProblem::Foundation(parameters, 0));
    const int instant = static_cast<int>(random.Index(stance.time.size()));
    const PoseDeviation deviation = stance.motion_errors.At(parameters, instant);
    const Vec3 place(random.Uniform(-1e-3, 1e-3), random.Uniform(-3e-4, 3e-4), random.Uniform(-1e-3, 1e-3));
    const std::vector<Vec3> places(stance.parts.size(), place);
    const double side = round % 2 == 0 ? 1 : -1;
    posed.Place(stance.kinematics, stance.foot, 0.001, instant, deviation, places, side, true);
    posed.ComputeLoad(stance.foot, beds, true, once, once_by_pose, once_by_place);
    ComputeEffectLoad(posed.kinematics(), 0, beds, {}, {false, true, false, true}, summed);
    posed.Differentiate(stance.foot, summed, by_pose, by_place);
    if (summed.load[kForceY] > 0) ++touching;
    EXPECT_LE((once.load - summed.load).norm(), kRounding * summed.load.norm());
    EXPECT_LE((once_by_pose - by_pose).norm(), kRounding * by_pose.norm());
    EXPECT_LE((once.by_part[0] - summed.by_part[0]).norm(), kRounding * summed.by_part[0].norm());
    EXPECT_LE((once_by_place[0] - by_place[0]).norm(), kRounding * by_place[0].norm());
  }
  EXPECT_GT(touching, 25);
}

TEST(MotionErrors, PredictAllocatesNothingInSteadyState) {
#ifdef SINEW_COUNTS_ALLOCATIONS
  const auto problem = MakeContact(ExactData(), Moving(kErrors)).value();
  Prediction prediction(problem->layout());
  const auto workspace = problem->NewWorkspace();
  const std::vector<bool> all(problem->layout().size(), true);
  Random random(1);
  const Vector parameters = RandomInside(*problem, 0, random);
  ASSERT_TRUE(problem->Predict({parameters, all, true, nullptr}, *workspace, prediction));
  const long before = Allocations();
  ASSERT_TRUE(problem->Predict({parameters, all, true, nullptr}, *workspace, prediction));
  EXPECT_EQ(Allocations() - before, 0);
#else
  GTEST_SKIP() << "this build has an allocator of its own";
#endif
}

TEST(MotionErrors, ThePriorIsNotSmallerThanThePublishedOne) {
  const auto problem = MakeContact(ExactData(), Moving("motion_errors: {}")).value();
  const StanceMotionErrors& errors = problem->data().stances.front().motion_errors;
  EXPECT_FALSE(problem->data().stances.front().markers.markers.empty());
  // The robot's markers lie where its encoders have them; 5 mm, part of it the stance.s own.
  EXPECT_NEAR(errors.deviation[kShiftX], 0.005, 1e-9);
  EXPECT_NEAR(errors.SpectrumAt(RestPoint(*problem), DeviationOf::kStance).scale, std::sqrt(0.5), 1e-9);
  EXPECT_NEAR(errors.SpectrumAt(RestPoint(*problem), DeviationOf::kAll).scale, std::sqrt(0.5), 1e-9);
}

// 1 mm of a marker from frame to frame.
TEST(MotionErrors, NoiseOfTheMarkersIsInTheStancesOwnCurves) {
  Dataset data = ExactData();
  Random random(9);
  for (auto& [name, trial] : data.trials) {
    for (auto& [channel, values] : trial.grids.at("markers").channels) {
      for (double& value : values.values) value += 1e-3 * random.Normal();
    }
  }
  const auto problem = MakeContact(data, Moving("motion_errors: {between_steps: 2}")).value();
  for (const Stance& stance : problem->data().stances) {
    EXPECT_NEAR(stance.pose_noise.marker, 1e-3, 3e-4);
    const StanceMotionErrors& errors = stance.motion_errors;
    double share = 0;
    for (const int component : errors.components) {
      const auto c = static_cast<std::size_t>(component);
      share += std::pow(stance.pose_noise.deviation[c] / errors.deviation[c], 2);
    }
    share /= static_cast<double>(errors.components.size());
    EXPECT_GT(share, 1e-4);
    const CurveSpectrum own = errors.SpectrumAt(RestPoint(*problem), DeviationOf::kStance);
    EXPECT_NEAR(own.noise * own.scale * own.scale, share, 1e-9 * share);
    EXPECT_EQ(own.noise_time, stance.pose_noise.time);
    EXPECT_EQ(errors.SpectrumAt(RestPoint(*problem), DeviationOf::kAll).noise, 0);
  }
}

TEST(MotionErrors, HowMuchStancesHaveInCommonIsChosenFromSeveral) {
  const auto between_steps = [](const ContactProblem& problem) {
    const int index = problem.data().stances.front().motion_errors.spectrum + 2;
    return problem.parameters()[static_cast<std::size_t>(index)];
  };
  const auto several = MakeContact(ExactData(), Moving("motion_errors: {}")).value();
  EXPECT_EQ(between_steps(*several).name, "deviation_between_steps");
  EXPECT_FALSE(between_steps(*several).other_starts.empty());
  const auto one = MakeContact(OneStance(), Moving("motion_errors: {}")).value();
  EXPECT_TRUE(between_steps(*one).other_starts.empty()) << "one stance does not tell";
  const auto set = MakeContact(ExactData(), Moving("motion_errors: {between_steps: 3}")).value();
  EXPECT_TRUE(between_steps(*set).other_starts.empty());
  const StanceMotionErrors& errors = set->data().stances.front().motion_errors;
  EXPECT_NEAR(errors.SpectrumAt(RestPoint(*set), DeviationOf::kStance).scale, std::sqrt(0.9), 1e-9);
  EXPECT_NEAR(errors.SpectrumAt(RestPoint(*set), DeviationOf::kAll).scale, std::sqrt(0.1), 1e-9);
}

TEST(MotionErrors, AnotherPriorPredictsTheSameWithOtherWeights) {
  const auto problem =
      MakeContact(ExactData(), Moving("motion_errors: {position: 0.0001, rotation: 0.001}")).value();
  Random random(4);
  Vector at = RestPoint(*problem);
  for (std::size_t i = 0; i < problem->parameters().size(); ++i) {
    const Parameter& p = problem->parameters()[i];
    if (p.kind == ParameterKind::kNuisance && p.prior) at[static_cast<Eigen::Index>(i)] = random.Normal();
  }
  Vector priors = at;
  for (std::size_t i = 0; i < problem->parameters().size(); ++i) {
    const Parameter& p = problem->parameters()[i];
    if (p.kind == ParameterKind::kPrior)
      priors[static_cast<Eigen::Index>(i)] = p.other_starts.empty() ? p.start : p.other_starts.front();
  }
  const Vector carried = problem->AtPriors(at, priors, Problem::CarryOver::kSame);
  const Prediction before = PredictEverything(*problem, at);
  const Prediction after = PredictEverything(*problem, carried);
  for (std::size_t b = 0; b < problem->layout().size(); ++b) {
    const Vector expected = before.values(static_cast<int>(b));
    EXPECT_LT((after.values(static_cast<int>(b)) - expected).norm(), 1e-6 * expected.norm()) << b;
  }
  EXPECT_GT((carried - at).norm(), 1);
  // What the other prior allows is only nearly the same.
  const Vector allowed = problem->AtPriors(at, priors, Problem::CarryOver::kAllowed);
  EXPECT_LT(allowed.cwiseAbs().tail(20).maxCoeff(), 8);
}

TEST(MotionErrors, SettingsThatCannotBeAreSaid) {
  const auto message = [](const std::string& keys) {
    const auto settings = ParseContactSettings(ExactData(), Moving(keys));
    return settings ? "none" : settings.error().message;
  };
  EXPECT_THAT(message("motion_errors: {position: 0}"), HasSubstr("position: 0, expected above 0"));
  EXPECT_THAT(message("motion_errors: {speed: 1}"), HasSubstr("speed"));
  EXPECT_THAT(message("motion_errors: {cutoff: 1e9}"), HasSubstr("expected at most 200"));
  const std::string thesis =
      SettingsText(ExactData(), "fit: [force_y]", "fit: [force_y]\n  motion_errors: {}");
  const auto refused = ParseContactSettings(ExactData(), thesis);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("takes objective likelihood"));
}

}  // namespace
}  // namespace sinew
