// The effects of the nms problem, on the ankle study.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "problems/ankle_study/nms_synthesis.h"
#include "problems/registry.h"
#include "tests/problems/support/jacobian_check.h"

namespace sinew {
namespace {

BoundProblem Bind(const Dataset& data) {
  const auto yaml = YamlReader::Parse(data.files.at("nms.yaml"), "nms.yaml");
  auto bound = (*FindProblem("nms"))->bind(data, *yaml, false);
  EXPECT_TRUE(bound) << bound.error().message;
  return std::move(*bound);
}

Dataset Study(const std::map<std::string, double>& set,
              const std::vector<std::pair<std::string, std::map<std::string, double>>>& effects = {}) {
  SynthesisRequest request;
  request.set = set;
  request.effects = effects;
  auto data = SynthesizeNms(request);
  EXPECT_TRUE(data) << data.error().message;
  return std::move(*data);
}

// Root mean square of what the problem leaves over, with these values instead of the study's.
double LeftOver(const Dataset& data, const std::map<std::string, double>& values) {
  const BoundProblem bound = Bind(data);
  Vector at = RestPoint(*bound.problem);
  const std::map<std::string, double> study{{"triceps.strength", 0.8},
                                            {"peronei.strength", 1.2},
                                            {"dorsiflexors.strength", 1.1},
                                            {"plantarflexors.shape", -1.2},
                                            {"dorsiflexors.shape", -0.8},
                                            {"triceps.tendon_slack_length", 1.01},
                                            {"dorsiflexors.tendon_slack_length", 0.98}};
  for (const auto& [name, value] : study) at[*FindParameter(bound.problem->parameters(), name)] = value;
  for (const auto& [name, value] : values) {
    const auto index = FindParameter(bound.problem->parameters(), name);
    EXPECT_TRUE(index) << name;
    if (index) at[*index] = value;
  }
  const Layout& layout = bound.problem->layout();
  Prediction prediction(layout);
  const auto workspace = bound.problem->NewWorkspace();
  EXPECT_TRUE(bound.problem->Predict({at, std::vector<bool>(layout.size(), true), false, nullptr}, *workspace,
                                     prediction));
  double squares = 0;
  double count = 0;
  for (std::size_t b = 0; b < layout.size(); ++b) {
    for (int i = 0; i < layout[b].samples(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      squares +=
          std::pow(prediction.values(static_cast<int>(b))[layout[b].sample[k]] - layout[b].measured[k], 2);
      count += 1;
    }
  }
  return std::sqrt(squares / count);
}

const std::map<std::string, double> kClean{
    {"moment_noise", 0}, {"electrodes", 0}, {"cycles", 1}, {"train", 2}, {"validate", 0}};

// Laboratory and model differ by less than a tenth of the noise of 1 N m.
TEST(NmsEffectsTest, TheStudyIsThatOfTheModel) {
  EXPECT_LT(LeftOver(Study(kClean), {}), 0.01);
}

struct Hidden {
  const char* effect;
  std::map<std::string, double> values;
  double share;  // of what the effect changes that the released one may leave over
};

// What the laboratory does and what the released effect says are the same thing.
TEST(NmsEffectsTest, EveryEffectIsThatOfTheLaboratory) {
  const std::string joint = ".ankle_angle_r";
  const Hidden kHidden[] = {
      {"emg_drift", {{"emg_drift", 0.02}}, 0.03},
      {"co_contraction", {{"co_contraction", 0.01}}, 0.03},
      {"cross_talk", {{"cross_talk", 0.1}}, 0.03},
      {"longer_delay", {{"longer_delay", 0.02}}, 0.03},
      {"slower_activation", {{"slower_activation", 0.5}}, 0.03},
      {"force_enhancement", {{"force_enhancement", 0.3}}, 0.05},
      {"force_depression", {{"force_depression", 0.2}}, 0.05},
      {"compliant_tendon", {{"compliant_tendon", 0.5}}, 0.1},
      {"contraction_velocity", {{"contraction_velocity", 0.3}}, 0.03},
      {"length_by_activation", {{"length_by_activation", 0.05}}, 0.03},
      {"fibre_length", {{"fibre_length", 0.05}}, 0.03},
      {"emg_gain@train_90", {{"emg_gain@train_90", 0.1}}, 0.03},
      {"emg_offset@train_90", {{"emg_offset@train_90", 0.01}}, 0.05},
      {"arm_offset.ankle_angle_r", {{"arm_offset" + joint, 0.003}}, 0.03},
      {"angle_offset.ankle_angle_r", {{"angle_offset" + joint, 0.05}}, 0.03},
      {"missing_muscle_plus.ankle_angle_r", {{"missing_muscle_plus" + joint, 5}}, 0.3},
      {"missing_muscle_minus.ankle_angle_r", {{"missing_muscle_minus" + joint, 20}}, 0.3},
      {"passive_stiffness.ankle_angle_r", {{"passive_stiffness" + joint, 10}}, 0.03},
      {"joint_damping.ankle_angle_r", {{"joint_damping" + joint, 2}}, 0.03},
      {"inertial_moment.ankle_angle_r", {{"inertial_moment" + joint, 0.2}}, 0.1},
      {"segment_weight.ankle_angle_r", {{"weight_sine" + joint, 5}, {"weight_cosine" + joint, 3}}, 0.03},
      {"machine_friction.ankle_angle_r", {{"machine_friction" + joint, 3}}, 0.1},
  };
  for (const Hidden& hidden : kHidden) {
    const Dataset data = Study(kClean, {{hidden.effect, hidden.values}});
    const double without = LeftOver(data, {});
    const double with = LeftOver(data, hidden.values);
    EXPECT_GT(without, 0.1) << hidden.effect;
    EXPECT_LT(with, hidden.share * without) << hidden.effect << " " << without << " " << with;
  }
}

TEST(NmsEffectsTest, DerivativesOfEveryEffectAgreeWithDifferences) {
  const BoundProblem bound = Bind(Study({{"exact", 1}, {"cycles", 1}, {"train", 2}, {"validate", 0}}));
  Random random(3);
  const JacobianCheck check = CheckJacobian(*bound.problem, RandomInside(*bound.problem, 0.05, random));
  EXPECT_GT(check.compared, 0.5 * check.columns);
  EXPECT_LT(check.worst, 1e-5);
}

// As in a real recording, whose other trial no model predicted before its floor was taken off.
TEST(NmsEffectsTest, AFloorOfOneRecordingIsSaid) {
  Dataset data = Study({{"exact", 1}, {"cycles", 1}, {"train", 2}, {"validate", 1}});
  EXPECT_TRUE(Bind(data).notes.empty());
  for (double& e : data.trials.at("validate_75").grids.at("excitations").channels.at("soleus_r").values)
    e = std::min(1.0, e + 0.1);
  const std::vector<std::string> notes = Bind(data).notes;
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(
      notes.front().rfind("the excitation of soleus_r never falls below 0.12 in trial 'validate_75'", 0), 0U)
      << notes.front();
}

TEST(NmsEffectsTest, WhatTheStudyCannotContainIsRefused) {
  const auto failure = [](const std::string& effect, const std::string& parameter, double value) {
    SynthesisRequest request;
    request.set = {{"cycles", 1}};
    request.effects = {{effect, {{parameter, value}}}};
    const auto data = SynthesizeNms(request);
    return data ? std::string() : data.error().message;
  };
  EXPECT_EQ(failure("emg_drfit", "emg_drift", 0.1),
            "--effect: 'emg_drfit' does not exist; did you mean 'emg_drift'?");
  EXPECT_NE(failure("emg_drift", "emg_drift", 10).find("expected -0.0500 to 0.0500"), std::string::npos);
  EXPECT_NE(failure("emg_drift", "drift", 0.01).find("'drift' does not exist"), std::string::npos);
  EXPECT_NE(failure("ankle_angle_r_moment.saturation", "ankle_angle_r_moment.saturation", 0.01)
                .find("cannot contain"),
            std::string::npos);
}

}  // namespace
}  // namespace sinew
