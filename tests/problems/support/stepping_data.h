// The synthetic stepping robot, and problems bound to it.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/text.h"
#include "models/multibody/coordinate_trajectory.h"
#include "models/multibody/multibody_model.h"
#include "problems/contact/laboratory/synthesis.h"
#include "problems/contact/problem.h"

namespace sinew {

/// A truth that no start and no default of the problem is equal to.
inline const std::map<std::string, double> kTruth{{"stiffness", 7.5e5},
                                                  {"dissipation", 33},
                                                  {"static_friction", 0.95},
                                                  {"dynamic_friction", 0.55},
                                                  {"viscous_friction", 0.45}};
/// With every effect at its null.
inline Vector TruthOf(const Problem& problem) {
  Vector parameters = RestPoint(problem);
  for (std::size_t i = 0; i < problem.parameters().size(); ++i) {
    if (problem.parameters()[i].kind == ParameterKind::kEffect) continue;
    const std::string& name = problem.parameters()[i].name;
    const auto dot = name.find('.');  // GROUP.stiffness
    parameters[static_cast<Eigen::Index>(i)] =
        kTruth.at(dot == std::string::npos ? name : name.substr(dot + 1));
  }
  return parameters;
}

/// The robot of kTruth with joint encoders, so that no inverse kinematics is needed.
/// @param settings of the experiment on top of that.
inline Dataset SteppingData(const std::map<std::string, double>& settings = {},
                            std::optional<double> noise = {}) {
  SynthesisRequest request;
  request.set = kTruth;
  request.set["encoders"] = 1;
  for (const auto& [name, value] : settings) request.set[name] = value;
  request.noise = noise;
  auto data = SynthesizeContact(request);
  EXPECT_TRUE(data) << data.error().message;
  return data ? std::move(*data) : Dataset{};
}

/// Made by the fitted model itself, without noise; two stances to fit and one to predict.
inline const Dataset& ExactData() {
  static const Dataset kData = SteppingData({{"fine", 0}, {"train", 2}, {"validate", 1}}, 0);
  return kData;
}

/// The settings text of the data, with one text in it replaced by another, everywhere.
inline std::string SettingsText(const Dataset& data, const std::string& what = "",
                                const std::string& by = "") {
  std::string text = data.files.at("contact.yaml");
  if (what.empty()) return text;
  EXPECT_NE(text.find(what), std::string::npos) << what;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
  return text;
}

inline Result<ContactSettings> ParseContactSettings(const Dataset& data, const std::string& yaml) {
  SINEW_ASSIGN(const YamlReader document, YamlReader::Parse(yaml, "contact.yaml"));
  SINEW_ASSIGN(const YamlReader section, document.At("contact"));
  return ReadContactSettings(section, data.files);
}

inline Result<std::unique_ptr<ContactProblem>> MakeContact(const Dataset& data, const std::string& yaml,
                                                           double margin = 0) {
  SINEW_ASSIGN(ContactSettings settings, ParseContactSettings(data, yaml));
  return ContactProblem::Make(data, std::move(settings), margin);
}

/// Of ExpectJacobianAgrees: a sole that gives way remembers the instants before.
inline constexpr double kSoleWithMemory = 0.8;

/// Every channel of a plate is predicted; the fitted ones are these.
inline const char* const kFitsVertical = "fit: [force_y]";
inline const char* const kFitsForce = "fit: [force_x, force_y, force_z]";

/// Each sole as a heel and a forefoot with parameters of their own, together the box of the data's settings.
inline const char* const kHeelAndForefoot = R"(contact:
  objective: thesis
  fit: [force_x, force_y, force_z]
  regions:
    - {name: right_heel, body: calcn_r, plate: right, group: heel, position: [-0.02, -0.04519, 0.0],
       mesh: {box: {size: [0.08, 0.02, 0.09], strips: [6, 7]}}}
    - {name: right_forefoot, body: calcn_r, plate: right, group: forefoot, position: [0.06, -0.04519, 0.0],
       mesh: {box: {size: [0.08, 0.02, 0.09], strips: [6, 7]}}}
    - {name: left_heel, body: calcn_l, plate: left, group: heel, position: [-0.02, -0.04519, 0.0],
       mesh: {box: {size: [0.08, 0.02, 0.09], strips: [6, 7]}}}
    - {name: left_forefoot, body: calcn_l, plate: left, group: forefoot, position: [0.06, -0.04519, 0.0],
       mesh: {box: {size: [0.08, 0.02, 0.09], strips: [6, 7]}}}
)";

/// Every block of the problem at these parameters, with derivatives.
inline Prediction PredictEverything(const Problem& problem, const Vector& parameters) {
  Prediction prediction(problem.layout());
  const auto workspace = problem.NewWorkspace();
  const std::vector<bool> all(problem.layout().size(), true);
  const Status status = problem.Predict({parameters, all, true, nullptr}, *workspace, prediction);
  EXPECT_TRUE(status) << status.error().message;
  return prediction;
}

/// The motion that was recorded, as a function of time.
inline CoordinateTrajectory RecordedMotion(const MultibodyModel& model, const Grid& recorded) {
  Matrix values(static_cast<Eigen::Index>(recorded.time.size()),
                static_cast<Eigen::Index>(recorded.channels.size()));
  std::vector<std::string> names;
  for (const auto& [name, channel] : recorded.channels) {
    values.col(static_cast<Eigen::Index>(names.size())) =
        Eigen::Map<const Vector>(channel.values.data(), values.rows());
    names.push_back(name);
  }
  return CoordinateTrajectory::Fit(model, recorded.time, names, values).value();
}

/// The robot's contact.yaml with motion that may deviate, all channels fitted to 1 N.
inline std::string MovingSettings(const Dataset& data) {
  std::string text = SettingsText(
      data, kFitsVertical,
      std::string(kFitsForce) + "\n  motion_errors: {position: 0.001, rotation: 0.005, cutoff: 8}");
  const std::string objective = "objective: thesis";
  return text.replace(text.find(objective), objective.size(),
                      "objective: likelihood\n  accuracy: {force: 1}");
}

}  // namespace sinew
