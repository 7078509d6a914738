#include "problems/drive/laboratory/exact.h"

#include "identify/observation/sensor_effects.h"
#include "problems/drive/problem.h"
#include "problems/kit/bind.h"

namespace sinew {
namespace {

Status Set(const std::string& name, double value, const Problem& problem, Vector& parameters) {
  SINEW_ASSIGN(const int index, FindParameter(problem.parameters(), name));
  parameters[index] = value;
  return {};
}

}  // namespace

Status MakeExact(const DriveTruth& truth, const std::map<std::string, double>& starts, Dataset& data) {
  SINEW_ASSIGN(const YamlReader section, SettingsSection(data, "drive"));
  SINEW_ASSIGN(const DriveSettings drive, ReadDriveSettings(section));
  SINEW_ASSIGN(auto bare, DriveProblem::Make(data, drive));
  const SensorEffects problem(std::move(bare));

  Vector parameters = RestPoint(problem);
  SINEW_TRY(Set("inertia", truth[kInertia], problem, parameters));
  SINEW_TRY(Set("viscous_friction", truth[kViscousFriction], problem, parameters));
  SINEW_TRY(Set("gravity_torque", truth[kGravityTorque], problem, parameters));
  for (const auto& [name, trial] : data.trials) {
    for (const char* state : {"initial_position@", "initial_speed@"}) {
      const auto start = starts.find(state + name);
      SINEW_TRY(Set(state + name, start != starts.end() ? start->second : 0, problem, parameters));
    }
  }
  const bool reference = data.trials.begin()->second.Find("reference").channel != nullptr;
  for (const DriveTruthEntry& entry : DriveTruthEntries(reference ? "reference" : "torque")) {
    if (truth[entry.slot] == DriveTruth()[entry.slot]) continue;
    SINEW_TRY(Set(entry.parameter, truth[entry.slot], problem, parameters));
  }

  const Layout& layout = problem.layout();
  const std::vector<bool> all(layout.size(), true);
  Prediction prediction(layout);
  const auto workspace = problem.NewWorkspace();
  SINEW_TRY(problem.Predict({parameters, all, false, nullptr}, *workspace, prediction));
  for (std::size_t b = 0; b < layout.size(); ++b) {
    const Block& block = layout[b];
    Grid& grid = data.trials.at(block.trial).grids.at("joint");
    const auto channel = grid.channels.find(block.channel);
    if (channel == grid.channels.end() || channel->second.kind == ChannelKind::kInput) continue;
    const auto values = prediction.values(static_cast<int>(b));
    // A channel that is measured but not fitted is predicted at its samples too.
    const bool compared = block.sample.size() == grid.time.size();
    if (!compared && block.prediction_time.size() != grid.time.size()) {
      return Fail("exact data: '{}' is not predicted at its samples", block.channel);
    }
    for (std::size_t i = 0; i < grid.time.size(); ++i) {
      channel->second.values[i] = values[compared ? block.sample[i] : static_cast<Eigen::Index>(i)];
    }
  }
  return {};
}

}  // namespace sinew
