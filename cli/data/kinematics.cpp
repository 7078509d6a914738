// sinew data kinematics: inverse kinematics of every trial with markers.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>

#include "base/numbers.h"
#include "base/text.h"
#include "cli/data/data_commands.h"
#include "cli/terminal.h"
#include "datasets/io/dataset_file.h"
#include "models/multibody/inverse_kinematics.h"
#include "models/multibody/osim_reader.h"

namespace sinew {
namespace {

struct KinematicsWords {
  std::string path;
  std::string model;
  std::string weights;
  bool quiet = false;
};

// A marker is three channels NAME_x, NAME_y, NAME_z of the grid `markers`.
MarkerTrajectories MarkersOf(const Grid& grid) {
  MarkerTrajectories markers;
  markers.times = grid.time;
  markers.positions.resize(grid.time.size());
  for (const auto& [name, x] : grid.channels) {
    if (name.size() < 3 || name.substr(name.size() - 2) != "_x") continue;
    const std::string marker = name.substr(0, name.size() - 2);
    const auto y = grid.channels.find(marker + "_y");
    const auto z = grid.channels.find(marker + "_z");
    if (y == grid.channels.end() || z == grid.channels.end()) continue;
    markers.names.push_back(marker);
    for (std::size_t i = 0; i < grid.time.size(); ++i) {
      markers.positions[i].emplace_back(x.values[i], y->second.values[i], z->second.values[i]);
    }
  }
  return markers;
}

Grid ToGrid(const IkResult& result, const MultibodyModel& model) {
  Grid grid;
  grid.time = result.times;
  for (std::size_t c = 0; c < result.coordinate_names.size(); ++c) {
    const std::string& name = result.coordinate_names[c];
    const auto column = result.coordinates.col(static_cast<Eigen::Index>(c));
    grid.channels[name] = {model.IsRotational(name) ? "rad" : "m", ChannelKind::kInput, std::nullopt,
                           std::vector<double>(column.data(), column.data() + column.size())};
  }
  return grid;
}

constexpr const char* kRenameHint =
    "; rename with a map: sinew data import --map (see docs/import.md#markers)";

bool SharesMarker(const MarkerTrajectories& markers, const MultibodyModel& model) {
  const auto& known = model.marker_names();
  return std::any_of(markers.names.begin(), markers.names.end(), [&](const std::string& name) {
    return std::find(known.begin(), known.end(), name) != known.end();
  });
}

std::string Describe(const std::string& trial, const IkResult& result) {
  double squares = 0;
  double worst = 0;
  int seen = 0;
  for (Eigen::Index i = 0; i < result.marker_rms_m.size(); ++i) {
    if (!std::isfinite(result.marker_rms_m[i])) continue;
    squares += result.marker_rms_m[i] * result.marker_rms_m[i];
    worst = std::max(worst, result.marker_max_m[i]);
    ++seen;
  }
  std::string text = fmt::format(
      "{}: {} frames, {} markers: {} mm RMS, {} mm at most", trial, result.times.size(),
      result.tracked.size(), Readable(1e3 * std::sqrt(squares / std::max(1, seen))), Readable(1e3 * worst));
  if (!result.unmatched.empty()) text += "\n  not in the model, left out: " + Join(result.unmatched, ", ");
  if (!result.undetermined.empty()) text += "\n  no marker moves with: " + Join(result.undetermined, ", ");
  if (!result.unconverged.empty())
    text += fmt::format("\n  {} frames did not converge", result.unconverged.size());
  return text + "\n";
}

Result<int> Kinematics(const KinematicsWords& words) {
  SINEW_ASSIGN(Dataset data, ReadDataset(words.path));
  if (!words.model.empty()) {
    SINEW_ASSIGN(data.files["model.osim"], ReadText(words.model));
  }
  const auto file = data.files.find("model.osim");
  if (file == data.files.end()) return Fail("{}: holds no model.osim: expected --model M.osim", words.path);
  SINEW_ASSIGN(const OsimModel osim,
               ReadOsim(file->second, words.model.empty() ? words.path + "/files/model.osim" : words.model));
  SINEW_ASSIGN(const MultibodyModel model, MultibodyModel::Build(osim));
  IkSetup setup;
  if (!words.weights.empty()) {
    SINEW_ASSIGN(const std::string text, ReadText(words.weights));
    SINEW_ASSIGN(setup, ReadIkSetup(text, words.weights));
  }

  std::string report;
  for (auto& [name, trial] : data.trials) {
    const auto grid = trial.grids.find("markers");
    if (grid == trial.grids.end()) continue;
    ProgressLine line("kinematics of " + name, words.quiet);
    IkOptions options;
    options.progress = [&line](int done, int all) { line.Show(done, all); };
    const MarkerTrajectories markers = MarkersOf(grid->second);
    const auto solved =
        SolveInverseKinematics(model, markers, words.weights.empty() ? nullptr : &setup, options);
    if (!solved) {
      return Fail("{}: trial '{}': {}{}", words.path, name, solved.error().message,
                  SharesMarker(markers, model) ? "" : kRenameHint);
    }
    trial.grids["coordinates"] = ToGrid(*solved, model);
    report += Describe(name, *solved);
  }
  if (report.empty()) return Fail("{}: no trial has a grid 'markers'", words.path);
  SINEW_TRY(WriteDataset(words.path, data));
  std::fputs(report.c_str(), stdout);
  return kDone;
}

}  // namespace

void AddKinematicsCommand(Command data, const RunAction& run) {
  auto words = std::make_shared<KinematicsWords>();
  Command command =
      data.AddCommand("kinematics", "Inverse kinematics: markers become coordinates of a model");
  command.Add("file", words->path).Required().Shows("F.h5");
  command.Add("--model", words->model, "OpenSim model; default: model.osim inside the data set")
      .Shows("M.osim");
  command
      .Add("--weights", words->weights,
           "OpenSim inverse kinematics setup with marker weights; default: all 1")
      .Shows("SETUP.xml");
  command.AddFlag("--quiet", words->quiet, "Print no progress");
  command.Runs(run, [=] { return Kinematics(*words); });
}

}  // namespace sinew
