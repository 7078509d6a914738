#include "problems/marker_kinematics.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>

#include "identify/execution/executor.h"

namespace sinew {
namespace {

constexpr const char* kRenameHint =
    "; rename with a map: sinew data import --map (see docs/import.md#markers)";

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
    grid.channels[name] = {model.IsAngle(name) ? "rad" : "m", ChannelKind::kInput, std::nullopt,
                           std::vector<double>(column.data(), column.data() + column.size())};
  }
  return grid;
}

bool SharesMarker(const MarkerTrajectories& markers, const MultibodyModel& model) {
  const auto& known = model.marker_names();
  return std::any_of(markers.names.begin(), markers.names.end(), [&](const std::string& name) {
    return std::find(known.begin(), known.end(), name) != known.end();
  });
}

KinematicsFit FitOf(const std::string& trial, const IkResult& result) {
  KinematicsFit fit;
  fit.trial = trial;
  fit.frames = result.times.size();
  fit.markers = result.tracked.size();
  double squares = 0;
  int seen = 0;
  for (Eigen::Index i = 0; i < result.marker_rms_m.size(); ++i) {
    if (!std::isfinite(result.marker_rms_m[i])) continue;
    squares += result.marker_rms_m[i] * result.marker_rms_m[i];
    ++seen;
    if (result.marker_max_m[i] < fit.max_m) continue;
    fit.max_m = result.marker_max_m[i];
    fit.worst_frame = static_cast<std::size_t>(i);
    fit.worst_marker = result.worst_marker[fit.worst_frame];
    fit.worst_time = result.times[fit.worst_frame];
  }
  fit.rms_m = std::sqrt(squares / std::max(1, seen));
  fit.unmatched = result.unmatched;
  fit.undetermined = result.undetermined;
  fit.undetermined_in = result.undetermined_in;
  fit.unconverged = result.unconverged.size();
  fit.starts = result.starts;
  fit.agreeing_starts = result.agreeing_starts;
  fit.redone = result.redone.size();
  return fit;
}

}  // namespace

Result<std::vector<KinematicsFit>> AddCoordinates(const MultibodyModel& model, const IkSetup* setup,
                                                  std::uint64_t seed,
                                                  const std::function<void(int done, int all)>& progress,
                                                  Dataset& data) {
  std::vector<std::pair<std::string, Trial*>> trials;
  int frames = 0;
  for (auto& [name, trial] : data.trials) {
    const auto grid = trial.grids.find("markers");
    if (grid == trial.grids.end()) continue;
    trials.emplace_back(name, &trial);
    frames += static_cast<int>(grid->second.time.size());
  }

  std::mutex mutex;
  int done = 0;
  IkOptions options;
  options.seed = seed;
  options.progress = [&](int /*of_trial*/, int /*all*/) {
    const std::lock_guard lock(mutex);
    ++done;
    if (progress) progress(done, frames);
  };
  std::vector<std::optional<Result<KinematicsFit>>> fits(trials.size());
  CurrentExecutor().ForEach(trials.size(), [&](std::size_t i, std::size_t) {
    auto& [name, trial] = trials[i];
    const MarkerTrajectories markers = MarkersOf(trial->grids.at("markers"));
    const auto solved = SolveInverseKinematics(model, markers, setup, options);
    if (!solved) {
      fits[i] = Fail("trial '{}': {}{}", name, solved.error().message,
                     SharesMarker(markers, model) ? "" : kRenameHint);
      return;
    }
    trial->grids["coordinates"] = ToGrid(*solved, model);
    fits[i] = FitOf(name, *solved);
  });

  std::vector<KinematicsFit> all;
  for (auto& fit : fits) {
    SINEW_ASSIGN(KinematicsFit one, std::move(*fit));
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace sinew
