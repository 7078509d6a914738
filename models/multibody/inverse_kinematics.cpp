#include "models/multibody/inverse_kinematics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text.h"
#include "models/multibody/frame_passes.h"
#include "models/multibody/name_lists.h"

namespace sinew {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Status CheckSizes(const MarkerTrajectories& markers) {
  if (markers.positions.size() != markers.times.size())
    return Fail("markers have {} frames but {} times", markers.positions.size(), markers.times.size());
  for (std::size_t i = 0; i < markers.positions.size(); ++i) {
    if (markers.positions[i].size() != markers.names.size()) {
      return Fail("marker frame {} has {} positions, expected {}", i, markers.positions[i].size(),
                  markers.names.size());
    }
  }
  return {};
}

double WeightOf(const std::string& marker, const IkSetup* setup) {
  if (setup == nullptr) return 1;
  for (const IkSetup::MarkerTask& task : setup->markers) {
    if (task.name == marker) return task.apply ? task.weight : 0;
  }
  return 0;
}

// Which markers to track; also fills the lists of names of the result.
Result<std::vector<TrackedMarker>> MatchMarkers(const MultibodyModel& model,
                                                const MarkerTrajectories& markers, const IkSetup* setup,
                                                IkResult& result) {
  const std::vector<std::string>& in_model = model.marker_names();
  std::vector<TrackedMarker> tracked;
  for (std::size_t i = 0; i < markers.names.size(); ++i) {
    const auto found = std::find(in_model.begin(), in_model.end(), markers.names[i]);
    if (found == in_model.end()) {
      result.unmatched.push_back(markers.names[i]);
      continue;
    }
    const double weight = WeightOf(markers.names[i], setup);
    if (weight <= 0) continue;
    tracked.push_back({static_cast<std::size_t>(found - in_model.begin()), i, weight});
    result.tracked.push_back(markers.names[i]);
  }
  if (result.unmatched.size() == markers.names.size()) {
    return Fail("marker set and motion share no marker: the model has {}, the motion has {}",
                ShowNames(in_model), ShowNames(markers.names));
  }
  if (tracked.empty()) {
    return Fail(
        "no marker that model and motion share has a positive weight; the setup has tasks for {} marker(s)",
        setup->markers.size());
  }
  return tracked;
}

Result<std::vector<CoordinateGoal>> ReadGoals(const MultibodyModel& model, const IkSetup* setup) {
  std::vector<CoordinateGoal> goals;
  if (setup == nullptr) return goals;
  for (const IkSetup::CoordinateTask& task : setup->coordinates) {
    if (!task.apply || task.weight == 0) continue;
    const auto index = model.CoordinateIndex(task.name);
    if (!index) return Fail("inverse kinematics setup: {}", index.error().message);
    if (task.target == IkSetup::Target::kFromFile) {
      return Fail(
          "inverse kinematics setup: coordinate task '{}' takes its values from a file, which is not "
          "supported; expected default_value or manual_value",
          task.name);
    }
    if (model.coordinate(*index).locked || model.IsDependent(*index)) continue;
    const bool manual = task.target == IkSetup::Target::kManualValue;
    goals.push_back({*index, manual ? task.value : model.default_values()[*index], task.weight});
  }
  return goals;
}

void StoreFrame(const MarkerFit& fit, const MultibodyModel& model, const std::vector<double>& distances,
                std::size_t frame, IkResult& result) {
  double sum = 0;
  for (const double distance : distances) sum += distance * distance;
  const auto worst = std::max_element(distances.begin(), distances.end());
  const auto row = static_cast<Eigen::Index>(frame);
  result.marker_rms_m[row] = std::sqrt(sum / static_cast<double>(distances.size()));
  result.marker_max_m[row] = *worst;
  result.worst_marker[frame] =
      model.marker_names()[fit.present()[static_cast<std::size_t>(worst - distances.begin())]];
}

void Store(MarkerFit& fit, const MultibodyModel& model, const MarkerTrajectories& markers, FramePoses poses,
           IkResult& result) {
  const auto frames = static_cast<Eigen::Index>(markers.times.size());
  result.coordinates.setConstant(frames, model.default_values().size(), kNan);
  result.marker_rms_m.setConstant(frames, kNan);
  result.marker_max_m.setConstant(frames, kNan);
  result.worst_marker.resize(markers.times.size());
  std::vector<int> without(fit.free_coordinates().size(), 0);  // frames in which nothing moves it
  int solved = 0;
  for (std::size_t frame = 0; frame < poses.of_frame.size(); ++frame) {
    const auto& pose = poses.of_frame[frame];
    if (!pose) continue;
    fit.SetFrame(markers.positions[frame]);
    result.coordinates.row(static_cast<Eigen::Index>(frame)) = pose->values;
    StoreFrame(fit, model, fit.Distances(pose->values), frame, result);
    const std::vector<bool> determined = fit.Determined({pose->values});
    for (std::size_t i = 0; i < without.size(); ++i) without[i] += determined[i] ? 0 : 1;
    ++solved;
    if (!pose->converged) result.unconverged.push_back(static_cast<int>(frame));
  }
  for (std::size_t i = 0; i < without.size(); ++i) {
    const std::string& name = model.coordinate(fit.free_coordinates()[i]).name;
    if (without[i] == solved) result.undetermined.push_back(name);
    if (without[i] > 0 && without[i] < solved) result.undetermined_in.emplace_back(name, without[i]);
  }
  result.starts = poses.starts;
  result.agreeing_starts = poses.agreeing_starts;
  result.redone = std::move(poses.redone);
}

}  // namespace

Result<IkResult> SolveInverseKinematics(const MultibodyModel& model, const MarkerTrajectories& markers,
                                        const IkSetup* setup, const IkOptions& options) {
  SINEW_TRY(CheckSizes(markers));
  IkResult result;
  SINEW_ASSIGN(std::vector<TrackedMarker> tracked, MatchMarkers(model, markers, setup, result));
  SINEW_ASSIGN(std::vector<CoordinateGoal> goals, ReadGoals(model, setup));
  try {
    MarkerFit fit(model, std::move(tracked), std::move(goals));
    if (fit.free_coordinates().empty()) return Fail("model '{}' has no free coordinate", model.name());
    result.times = markers.times;
    result.coordinate_names = model.coordinate_names();
    Store(fit, model, markers, SolveFrames(fit, model, markers, options), result);
  } catch (const std::exception& problem) {
    return Fail("inverse kinematics of model '{}' failed: {}", model.name(), OneLine(problem.what()));
  }
  return result;
}

}  // namespace sinew
