#include "models/multibody/inverse_kinematics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/constants.h"
#include "models/multibody/marker_fit.h"
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

// The model's default pose, and the same turned by quarter turns about each angle between ground and the
// first bodies.
std::vector<Vector> Starts(const MultibodyModel& model) {
  std::vector<Vector> starts{model.default_values()};
  for (int i = 0; i < static_cast<int>(model.coordinate_names().size()); ++i) {
    const OsimCoordinate& coordinate = model.coordinate(i);
    const bool turns =
        coordinate.motion == MotionType::kRotational && !coordinate.locked && !model.IsDependent(i);
    if (!turns || !model.IsGroundCoordinate(i)) continue;
    for (const double turn : {kPi / 2, kPi, -kPi / 2}) {
      Vector start = model.default_values();
      start[i] += turn;
      if (coordinate.clamped && (start[i] < coordinate.lower || start[i] > coordinate.upper)) continue;
      starts.push_back(std::move(start));
    }
  }
  return starts;
}

// Equal up to what the solver's accuracy leaves open.
bool IsAsGood(const MarkerFit::Solution& solution, double cost, const IkOptions& options) {
  constexpr double kMargin = 1.01;
  return solution.cost <= kMargin * cost + options.accuracy * options.accuracy;
}

// Angles without a range brought to within half a turn of the default, where that changes nothing.
MarkerFit::Solution WithoutWholeTurns(MarkerFit& fit, const MultibodyModel& model, const IkOptions& options,
                                      const MarkerFit::Solution& solution) {
  Vector wrapped = solution.values;
  for (const int i : fit.free_coordinates()) {
    const OsimCoordinate& coordinate = model.coordinate(i);
    if (coordinate.motion != MotionType::kRotational || coordinate.clamped) continue;
    wrapped[i] = model.default_values()[i] + std::remainder(wrapped[i] - model.default_values()[i], 2 * kPi);
  }
  if (wrapped == solution.values) return solution;
  const MarkerFit::Solution again = fit.Solve(wrapped, options.accuracy, options.max_iterations);
  return IsAsGood(again, solution.cost, options) ? again : solution;
}

// Of the minima that the starts lead to, the lowest; of equal ones (angles that describe one pose in two
// ways) the one nearest to the default pose.
MarkerFit::Solution SolveFirstFrame(MarkerFit& fit, const MultibodyModel& model, const IkOptions& options) {
  std::vector<MarkerFit::Solution> found;
  double lowest = std::numeric_limits<double>::infinity();
  for (const Vector& start : Starts(model)) {
    const MarkerFit::Solution solution = fit.Solve(start, options.accuracy, options.max_iterations);
    found.push_back(WithoutWholeTurns(fit, model, options, solution));
    lowest = std::min(lowest, found.back().cost);
  }
  MarkerFit::Solution best = found.front();
  double nearest = std::numeric_limits<double>::infinity();
  for (MarkerFit::Solution& solution : found) {
    const double distance = (solution.values - model.default_values()).norm();
    if (!IsAsGood(solution, lowest, options) || distance >= nearest) continue;
    nearest = distance;
    best = std::move(solution);
  }
  return best;
}

void Store(const MarkerFit::Solution& solution, const std::vector<double>& distances, Eigen::Index frame,
           IkResult& result) {
  result.coordinates.row(frame) = solution.values;
  double sum = 0;
  for (const double distance : distances) sum += distance * distance;
  result.marker_rms_m[frame] = std::sqrt(sum / static_cast<double>(distances.size()));
  result.marker_max_m[frame] = *std::max_element(distances.begin(), distances.end());
}

void SolveFrames(MarkerFit& fit, const MultibodyModel& model, const MarkerTrajectories& markers,
                 const IkOptions& options, IkResult& result) {
  const int frames = static_cast<int>(markers.times.size());
  result.coordinates.setConstant(frames, model.default_values().size(), kNan);
  result.marker_rms_m.setConstant(frames, kNan);
  result.marker_max_m.setConstant(frames, kNan);
  bool is_first = true;
  Vector previous;
  for (int frame = 0; frame < frames; ++frame) {
    if (fit.SetFrame(markers.positions[static_cast<std::size_t>(frame)])) {
      const MarkerFit::Solution solution =
          is_first ? SolveFirstFrame(fit, model, options)
                   : fit.Solve(previous, options.accuracy, options.max_iterations);
      if (!solution.converged) result.unconverged.push_back(frame);
      Store(solution, fit.Distances(solution.values), frame, result);
      previous = solution.values;
      is_first = false;
    }
    if (options.progress) options.progress(frame + 1, frames);
  }
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
    SolveFrames(fit, model, markers, options, result);
    for (std::size_t i = 0; i < fit.free_coordinates().size(); ++i) {
      if (!fit.ever_determined()[i])
        result.undetermined.push_back(model.coordinate(fit.free_coordinates()[i]).name);
    }
  } catch (const std::exception& problem) {
    return Fail("inverse kinematics of model '{}' failed: {}", model.name(), problem.what());
  }
  return result;
}

}  // namespace sinew
