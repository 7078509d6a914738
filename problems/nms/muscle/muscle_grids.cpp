#include "problems/nms/muscle/muscle_grids.h"

#include <algorithm>

#include "base/text.h"
#include "models/multibody/osim_muscle_reader.h"
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
                                       std::vector<std::string> muscles,
                                       const std::vector<std::string>& joints, const std::string& asked_by) {
  SINEW_ASSIGN(const OsimModel osim, ReadOsim(text, name));
  SINEW_ASSIGN(MultibodyModel built, MultibodyModel::Build(osim));
  auto model = std::make_unique<const MultibodyModel>(std::move(built));
  SINEW_ASSIGN(std::vector<int> indices, FindJoints(*model, joints, asked_by));
  if (muscles.empty()) {
    SINEW_ASSIGN(muscles, ListOsimMuscles(text, name));
  }
  if (muscles.empty()) return Fail("{}: the model has no muscles", name);
  SINEW_ASSIGN(const auto paths, ReadOsimMuscles(text, name, osim, muscles));
  SINEW_ASSIGN(MuscleGeometry geometry, MuscleGeometry::Build(*model, paths));
  return MuscleGrids(std::move(model), std::move(geometry), joints, std::move(indices));
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
