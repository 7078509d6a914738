#include "problems/nms/muscle/muscle_grids.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/text.h"
#include "models/multibody/osim_reader.h"

namespace sinew {
namespace {

Result<std::vector<int>> FindJoints(const MultibodyModel& model, const std::vector<std::string>& names,
                                    const std::string& asked_by) {
  std::vector<int> joints;
  for (const std::string& name : names) {
    const auto index = model.CoordinateIndex(name);
    if (!index) return Fail("{}: {}", asked_by, index.error().message);
    if (model.coordinate(*index).motion == MotionType::kTranslational)
      return Fail("{}: coordinate '{}' is a length, expected an angle", asked_by, name);
    if (model.IsDependent(*index))
      return Fail("{}: coordinate '{}' follows from another one, expected an independent angle", asked_by,
                  name);
    if (std::count(names.begin(), names.end(), name) > 1)
      return Fail("{}: coordinate '{}' is given twice", asked_by, name);
    joints.push_back(*index);
  }
  return joints;
}

// The independent angles about which some muscle has a moment arm at one of three poses within the ranges of
// the coordinates: at a single one an arm may be zero by chance.
Result<std::vector<int>> FindMovedJoints(const MultibodyModel& model, const MuscleGeometry& muscles) {
  constexpr double kNoArm_m = 1e-9;
  std::vector<int> angles;
  const auto count = static_cast<int>(model.coordinate_names().size());
  for (int c = 0; c < count; ++c) {
    if (model.coordinate(c).motion == MotionType::kRotational && !model.IsDependent(c)) angles.push_back(c);
  }
  std::set<int> moved;
  for (const double share : {0.0, 0.3, 0.6}) {
    Vector pose = model.default_values();
    for (const int c : angles) {
      const double room = model.coordinate(c).upper - model.coordinate(c).lower;
      if (share > 0)
        pose[c] = std::isfinite(room) ? model.coordinate(c).lower + share * room : pose[c] + share;  // [rad]
    }
    const auto state = muscles.At(pose, Vector::Zero(count), angles);
    if (!state && share > 0) continue;  // not every pose needs to be possible
    if (!state) return tl::unexpected(state.error());
    for (std::size_t a = 0; a < angles.size(); ++a) {
      if (state->moment_arms.col(static_cast<Eigen::Index>(a)).cwiseAbs().maxCoeff() > kNoArm_m)
        moved.insert(angles[a]);
    }
  }
  return std::vector<int>(moved.begin(), moved.end());
}

Grid ToGrid(const std::vector<double>& time, const std::vector<std::string>& muscles, const Matrix& values) {
  Grid grid;
  grid.time = time;
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    const auto column = values.col(static_cast<Eigen::Index>(m));
    grid.channels[muscles[m]] = {"m", ChannelKind::kInput, std::nullopt,
                                 std::vector<double>(column.data(), column.data() + column.size())};
  }
  return grid;
}

}  // namespace

MuscleGrids::MuscleGrids(std::unique_ptr<const MultibodyModel> model, MuscleGeometry muscles,
                         std::vector<std::string> joints, std::vector<int> indices)
    : model_(std::move(model)),
      muscles_(std::move(muscles)),
      joints_(std::move(joints)),
      joint_indices_(std::move(indices)) {}

Result<MuscleGrids> MuscleGrids::Build(const std::string& text, const std::string& name,
                                       MuscleGridsRequest request) {
  SINEW_ASSIGN(const OsimModel osim, ReadOsim(text, name));
  SINEW_ASSIGN(MultibodyModel built, MultibodyModel::Build(osim));
  auto model = std::make_unique<const MultibodyModel>(std::move(built));
  auto& [muscles, joints, skip_unsupported, asked_by, remedy] = request;
  const bool every_joint = joints == std::vector<std::string>{"all"};
  std::vector<int> indices;
  if (!every_joint) {
    SINEW_ASSIGN(indices, FindJoints(*model, joints, asked_by));
  }
  if (muscles.empty()) {
    SINEW_ASSIGN(muscles, ListOsimMuscles(text, name));
  }
  if (muscles.empty()) return Fail("{}: the model has no muscles", name);
  std::vector<UnsupportedMuscle> skipped;
  if (skip_unsupported) {
    SINEW_ASSIGN(skipped, ListUnsupportedMuscles(text, name, osim, muscles));
    for (const UnsupportedMuscle& one : skipped)
      muscles.erase(std::remove(muscles.begin(), muscles.end(), one.muscle), muscles.end());
    if (muscles.empty())
      return Fail("{}: none of the muscles is supported, such as '{}' with {}", name, skipped.front().muscle,
                  skipped.front().part);
  }
  const auto read = ReadOsimMuscles(text, name, osim, muscles);
  if (!read && !remedy.empty()) {
    SINEW_ASSIGN(const auto unsupported, ListUnsupportedMuscles(text, name, osim, muscles));
    if (!unsupported.empty()) return Fail("{}; {}", read.error().message, remedy);
  }
  if (!read) return tl::unexpected(read.error());
  const std::vector<OsimMusclePath>& paths = *read;
  SINEW_ASSIGN(MuscleGeometry geometry, MuscleGeometry::Build(*model, paths));
  if (every_joint) {
    SINEW_ASSIGN(indices, FindMovedJoints(*model, geometry));
    joints.clear();
    for (const int index : indices) joints.push_back(model->coordinate(index).name);
    if (joints.empty()) return Fail("{}: all: the muscles move none of the model's angles", asked_by);
  }
  MuscleGrids grids(std::move(model), std::move(geometry), std::move(joints), std::move(indices));
  grids.skipped_ = std::move(skipped);
  for (const OsimMusclePath& path : paths) {
    if (path.wraps.size() > 1) grids.over_several_.push_back(path.name);
  }
  return grids;
}

// Names of the model's coordinates that lie on the grid.
std::vector<std::string> MuscleGrids::CoordinatesOn(const Grid& grid) const {
  std::vector<std::string> names;
  for (const std::string& name : model_->coordinate_names()) {
    if (grid.channels.count(name) > 0) names.push_back(name);
  }
  return names;
}

const Grid* MuscleGrids::FindMotion(const Trial& trial) const {
  const Grid* best = nullptr;
  std::size_t most = 0;
  for (const auto& [name, grid] : trial.grids) {
    const std::size_t count = CoordinatesOn(grid).size();
    if (count > most) {
      most = count;
      best = &grid;
    }
  }
  return best;
}

Result<CoordinateTrajectory> MuscleGrids::FitTrajectory(const Grid& grid) const {
  const std::vector<std::string> names = CoordinatesOn(grid);
  Matrix values(static_cast<Eigen::Index>(grid.time.size()), static_cast<Eigen::Index>(names.size()));
  for (std::size_t c = 0; c < names.size(); ++c) {
    const Channel& channel = grid.channels.at(names[c]);
    if (model_->IsRotational(names[c]) && channel.unit != "rad")
      return Fail(
          "channel '{}' has the unit {}, expected rad; import the file together with the model, which "
          "knows its angles",
          names[c], channel.unit);
    values.col(static_cast<Eigen::Index>(c)) =
        Eigen::Map<const Vector>(channel.values.data(), static_cast<Eigen::Index>(channel.values.size()));
  }
  return CoordinateTrajectory::Fit(*model_, grid.time, names, values);
}

Result<std::string> MuscleGrids::Add(const Grid& motion, Trial& trial) const {
  SINEW_ASSIGN(const CoordinateTrajectory trajectory, FitTrajectory(motion));
  const std::vector<std::string>& muscles = muscles_.names();
  const std::vector<double> time = motion.time;  // `motion` may be a grid of the trial
  SINEW_ASSIGN(const MuscleGeometrySeries series, muscles_.Along(time, trajectory, joint_indices_));
  trial.grids["lengths"] = ToGrid(time, muscles, series.lengths);
  for (std::size_t j = 0; j < joints_.size(); ++j)
    trial.grids["moment_arms." + joints_[j]] = ToGrid(time, muscles, series.moment_arms[j]);

  std::string said = fmt::format("{} frames: lengths of {} muscles, moment arms about {}\n", time.size(),
                                 muscles.size(), Join(joints_, ", "));
  const auto& held = trajectory.held();
  if (!held.empty()) {
    said += fmt::format("  not in the data, kept at the model's default{}: {}\n", held.size() == 1 ? "" : "s",
                        Join(held, ", "));
  }
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    if (series.unsettled[m] == 0) continue;
    said += fmt::format("  {}: in {} frames its path jumps between two ways over its wrap objects\n",
                        muscles[m], series.unsettled[m]);
  }
  return said;
}

}  // namespace sinew
