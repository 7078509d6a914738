// Joints on a bench of the tests: an input that a formula gives, and a problem bound to it.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "problems/drive/problem.h"

namespace sinew {

struct Bench {
  std::string input = "torque";
  std::string input_unit = "N*m";
  std::function<double(double)> command = [](double) { return 0.0; };
  double rate = 100;    // [Hz]
  double duration = 4;  // [s]
  bool rotary = true;
  bool speed = false;    // is measured too
  double step = 0.01;    // [s]
  std::string settings;  // more of drive.yaml
  std::map<std::string, double> constants;
  std::vector<double> times;  // instead of rate and duration
  struct Input {
    std::string unit;
    std::function<double(double)> value;
  };
  std::map<std::string, Input> inputs;  // besides the command
};

/// What is "measured" is any motion: the tests ask what is predicted.
inline Dataset BenchData(const Bench& bench) {
  Dataset data;
  Trial& trial = data.trials["swing"];
  Grid& grid = trial.grids["joint"];
  const int count = static_cast<int>(std::lround(bench.duration * bench.rate)) + 1;
  grid.time = bench.times;
  for (int i = 0; bench.times.empty() && i < count; ++i) grid.time.push_back(i / bench.rate);
  Channel& input = grid.channels[bench.input];
  input.unit = bench.input_unit;
  input.kind = ChannelKind::kInput;
  Channel& position = grid.channels["position"];
  position.unit = bench.rotary ? "rad" : "m";
  for (const double t : grid.time) {
    input.values.push_back(bench.command(t));
    position.values.push_back(0.8 * std::cos(5 * t));
  }
  if (bench.speed) {
    Channel& speed = grid.channels["speed"];
    speed.unit = bench.rotary ? "rad/s" : "m/s";
    for (const double t : grid.time) speed.values.push_back(-4 * std::sin(5 * t));
  }
  for (const auto& [name, further] : bench.inputs) {
    Channel& channel = grid.channels[name];
    channel.unit = further.unit;
    channel.kind = ChannelKind::kInput;
    for (const double t : grid.time) channel.values.push_back(further.value(t));
  }
  for (const auto& [name, value] : bench.constants) data.constants[name] = {value, "1"};
  data.files["drive.yaml"] =
      "{step: " + std::to_string(bench.step) + (bench.settings.empty() ? "" : ", " + bench.settings) + "}";
  return data;
}

inline Result<std::unique_ptr<DriveProblem>> BindDriveData(const Dataset& data, double margin = 0) {
  SINEW_ASSIGN(const YamlReader yaml, YamlReader::Parse(data.files.at("drive.yaml"), "drive.yaml"));
  SINEW_ASSIGN(const DriveSettings settings, ReadDriveSettings(yaml));
  return DriveProblem::Make(data, settings, margin);
}

inline std::unique_ptr<DriveProblem> BindBench(const Bench& bench) {
  auto problem = BindDriveData(BenchData(bench));
  EXPECT_TRUE(problem) << problem.error().message;
  return problem ? std::move(*problem) : nullptr;
}

/// Everything at rest but these; the joint starts at 0 unless told otherwise.
inline Vector DrivePoint(const Problem& problem, const std::map<std::string, double>& values) {
  Vector point = RestPoint(problem);
  std::map<std::string, double> all{{"initial_position@swing", 0}, {"initial_speed@swing", 0}};
  for (const auto& [name, value] : values) all[name] = value;
  for (const auto& [name, value] : all) {
    const auto index = FindParameter(problem.parameters(), name);
    EXPECT_TRUE(index) << index.error().message;
    if (index) point[*index] = value;
  }
  return point;
}

struct DriveAnswer {
  const Problem* problem;
  Prediction prediction;

  [[nodiscard]] int Block(const std::string& channel) const {
    const Layout& layout = problem->layout();
    for (std::size_t b = 0; b < layout.size(); ++b) {
      if (layout[b].channel == channel) return static_cast<int>(b);
    }
    ADD_FAILURE() << "no channel " << channel;
    return 0;
  }
  [[nodiscard]] Vector Values(const std::string& channel) const { return prediction.values(Block(channel)); }
  [[nodiscard]] Vector Derivative(const std::string& channel, const std::string& parameter) const {
    const int block = Block(channel);
    const int index = FindParameter(problem->parameters(), parameter).value();
    const auto& columns = problem->layout()[static_cast<std::size_t>(block)].columns;
    const auto column = std::find(columns.begin(), columns.end(), index) - columns.begin();
    return prediction.derivatives(block).col(column);
  }
};

inline DriveAnswer PredictDrive(const Problem& problem, const Vector& parameters,
                                const std::vector<bool>* differentiate = nullptr) {
  DriveAnswer answer{&problem, Prediction(problem.layout())};
  const auto workspace = problem.NewWorkspace();
  const std::vector<bool> all(problem.layout().size(), true);
  const Status status =
      problem.Predict({parameters, all, true, differentiate}, *workspace, answer.prediction);
  EXPECT_TRUE(status) << status.error().message;
  return answer;
}

}  // namespace sinew
