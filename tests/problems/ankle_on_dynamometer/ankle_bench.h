// Small experiments of the ankle problem.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "problems/ankle_on_dynamometer/problem.h"

namespace sinew {

constexpr const char* kAnkleYaml = R"(ankle_on_dynamometer:
  foot: {ankle_height: 0.08, heel: 0.05, toe: 0.17, width: 0.08, mass: 1.1, mass_x: 0.05, mass_y: -0.04, inertia: 0.008}
  straps:
    - {foot: [0.11, -0.03], plate: 0.11}
    - {foot: [0.02, 0], plate: 0.035}
  strips: 16
  step: 0.005
  muscles:
    soleus_r: {isometric_force: 3549, optimal_length: 0.05, tendon_slack_length: 0.262, pennation: 0.436,
               length: 0.314, arm: [-0.046, 0.002, 0.012], group: triceps}
    tib_ant_r: {isometric_force: 905, optimal_length: 0.098, tendon_slack_length: 0.223, pennation: 0.087,
                length: 0.316, arm: [0.041, -0.006, -0.02]}
  parameters:
    strap_stiffness: {start: 6000, lower: 1.0e3, upper: 1.0e5, prior: 0.5}
)";

inline Result<AnkleSettings> ReadAnkleYaml(const std::string& yaml) {
  SINEW_ASSIGN(const YamlReader document, YamlReader::Parse(yaml, "ankle.yaml"));
  SINEW_ASSIGN(const YamlReader section, document.At("ankle_on_dynamometer"));
  return ReadAnkleSettings(section);
}

inline AnkleSettings AnkleBenchSettings() {
  auto settings = ReadAnkleYaml(kAnkleYaml);
  EXPECT_TRUE(settings) << settings.error().message;
  return settings ? *settings : AnkleSettings();
}

/// The settings with a text replaced by another.
inline std::string ChangedAnkleYaml(const std::string& what, const std::string& by) {
  std::string yaml = kAnkleYaml;
  const auto at = yaml.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return yaml.replace(at, what.size(), by);
}

enum class AnkleBench { kAttachment, kPassive, kActive };

/// A second at 100 Hz on a plate that swings.
inline Trial AnkleBenchTrial(AnkleBench kind) {
  Trial trial;
  trial.conditions["foot"] = kind == AnkleBench::kAttachment ? 0 : 1;
  trial.conditions["passive"] = kind == AnkleBench::kPassive ? 1 : 0;
  Grid machine;
  Grid excitations;
  Channel angle{"rad", ChannelKind::kInput, {}, {}};
  Channel torque{"N*m", ChannelKind::kMeasured, 0.3, {}};
  Channel ankle{"rad", ChannelKind::kMeasured, 0.003, {}};
  Channel soleus{"1", ChannelKind::kInput, {}, {}};
  Channel tibialis{"1", ChannelKind::kInput, {}, {}};
  for (int i = 0; i <= 100; ++i) {
    const double t = 0.01 * i;
    machine.time.push_back(t);
    angle.values.push_back(-0.1 + 0.3 * std::cos(5 * t));
    torque.values.push_back(3 * std::sin(5 * t));
    ankle.values.push_back(-0.1 + 0.29 * std::cos(5 * t));
    excitations.time.push_back(t);
    soleus.values.push_back(0.3 - 0.28 * std::cos(6 * t));
    tibialis.values.push_back(0.2 + 0.18 * std::cos(6 * t));
  }
  machine.channels = {{"machine_angle", angle}, {"machine_torque", torque}};
  if (kind != AnkleBench::kAttachment) machine.channels["ankle_angle"] = ankle;
  trial.grids["machine"] = machine;
  excitations.channels = {{"soleus_r", soleus}, {"tib_ant_r", tibialis}};
  if (kind == AnkleBench::kActive) trial.grids["excitations"] = excitations;
  return trial;
}

/// One trial of each kind.
inline Dataset AnkleBenchData() {
  Dataset data;
  data.trials["alone"] = AnkleBenchTrial(AnkleBench::kAttachment);
  data.trials["relaxed"] = AnkleBenchTrial(AnkleBench::kPassive);
  data.trials["working"] = AnkleBenchTrial(AnkleBench::kActive);
  return data;
}

inline Grid& MachineGrid(Dataset& data, const std::string& trial) {
  return data.trials.at(trial).grids.at("machine");
}

inline std::unique_ptr<AnkleProblem> BindAnkleBench(const Dataset& data = AnkleBenchData(),
                                                    const AnkleSettings& settings = AnkleBenchSettings()) {
  auto problem = AnkleProblem::Make(data, settings);
  EXPECT_TRUE(problem) << problem.error().message;
  return problem ? std::move(*problem) : nullptr;
}

/// All blocks, without derivatives.
inline Prediction PredictAnkle(const Problem& problem, const Vector& parameters) {
  Prediction prediction(problem.layout());
  const auto workspace = problem.NewWorkspace();
  const std::vector<bool> all(problem.layout().size(), true);
  const Status status = problem.Predict({parameters, all, false, nullptr}, *workspace, prediction);
  EXPECT_TRUE(status) << status.error().message;
  return prediction;
}

inline const Block& BlockOf(const Problem& problem, const std::string& trial, const std::string& channel) {
  for (const Block& block : problem.layout()) {
    if (block.trial == trial && block.channel == channel) return block;
  }
  ADD_FAILURE() << "no block " << trial << " " << channel;
  return problem.layout().front();
}

}  // namespace sinew
