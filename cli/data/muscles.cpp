// sinew data muscles: lengths and moment arms of muscles along the joint angles of every trial.
#include <algorithm>
#include <cstdio>
#include <memory>

#include "base/text.h"
#include "cli/data/data_commands.h"
#include "cli/terminal.h"
#include "datasets/io/dataset_file.h"
#include "models/multibody/muscle_geometry.h"
#include "models/multibody/osim_muscle_reader.h"
#include "models/multibody/osim_reader.h"

namespace sinew {
namespace {

struct MusclesWords {
  std::string path;
  std::string model;
  std::vector<std::string> muscles;
  std::vector<std::string> joints;
  std::string out;
};

// The model with its muscles and the joints that were asked for.
struct Skeleton {
  std::unique_ptr<const MultibodyModel> model;  // the muscles refer to it
  MuscleGeometry muscles;
  std::vector<int> joints;
};

Result<std::vector<int>> FindJoints(const MultibodyModel& model, const std::vector<std::string>& names) {
  std::vector<int> joints;
  for (const std::string& name : names) {
    const auto index = model.CoordinateIndex(name);
    if (!index) return Fail("--joints: {}", index.error().message);
    if (model.coordinate(*index).motion == MotionType::kTranslational)
      return Fail("--joints: coordinate '{}' is a length, expected an angle", name);
    if (model.IsDependent(*index))
      return Fail("--joints: coordinate '{}' follows from another one, expected an independent angle", name);
    if (std::count(names.begin(), names.end(), name) > 1)
      return Fail("--joints: coordinate '{}' is given twice", name);
    joints.push_back(*index);
  }
  return joints;
}

Result<Skeleton> BuildSkeleton(const std::string& text, const std::string& name, const MusclesWords& words) {
  SINEW_ASSIGN(const OsimModel osim, ReadOsim(text, name));
  SINEW_ASSIGN(MultibodyModel built, MultibodyModel::Build(osim));
  auto model = std::make_unique<const MultibodyModel>(std::move(built));
  SINEW_ASSIGN(std::vector<int> joints, FindJoints(*model, words.joints));
  std::vector<std::string> wanted = words.muscles;
  if (wanted.empty()) {
    SINEW_ASSIGN(wanted, ListOsimMuscles(text, name));
  }
  if (wanted.empty()) return Fail("{}: the model has no muscles", name);
  SINEW_ASSIGN(const auto paths, ReadOsimMuscles(text, name, osim, wanted));
  SINEW_ASSIGN(MuscleGeometry muscles, MuscleGeometry::Build(*model, paths));
  return Skeleton{std::move(model), std::move(muscles), std::move(joints)};
}

// Names of the model's coordinates that lie on the grid.
std::vector<std::string> CoordinatesOn(const Grid& grid, const MultibodyModel& model) {
  std::vector<std::string> names;
  for (const std::string& name : model.coordinate_names()) {
    if (grid.channels.count(name) > 0) names.push_back(name);
  }
  return names;
}

// The grid with the most coordinates of the model; nullptr if there is none.
const Grid* FindMotion(const Trial& trial, const MultibodyModel& model) {
  const Grid* best = nullptr;
  std::size_t most = 0;
  for (const auto& [name, grid] : trial.grids) {
    const std::size_t count = CoordinatesOn(grid, model).size();
    if (count > most) {
      most = count;
      best = &grid;
    }
  }
  return best;
}

Result<CoordinateTrajectory> FitTrajectory(const Grid& grid, const MultibodyModel& model) {
  const std::vector<std::string> names = CoordinatesOn(grid, model);
  Matrix values(static_cast<Eigen::Index>(grid.time.size()), static_cast<Eigen::Index>(names.size()));
  for (std::size_t c = 0; c < names.size(); ++c) {
    const Channel& channel = grid.channels.at(names[c]);
    if (model.IsRotational(names[c]) && channel.unit != "rad")
      return Fail(
          "channel '{}' has the unit {}, expected rad; import the file together with the model, which "
          "knows its angles",
          names[c], channel.unit);
    values.col(static_cast<Eigen::Index>(c)) =
        Eigen::Map<const Vector>(channel.values.data(), static_cast<Eigen::Index>(channel.values.size()));
  }
  return CoordinateTrajectory::Fit(model, grid.time, names, values);
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

// Adds the grids; returns what there is to say.
Result<std::string> AddMuscles(const Skeleton& skeleton, const Grid& motion,
                               const std::vector<std::string>& joints, Trial& trial) {
  SINEW_ASSIGN(const CoordinateTrajectory trajectory, FitTrajectory(motion, *skeleton.model));
  const std::vector<std::string>& muscles = skeleton.muscles.names();
  const std::vector<double> time = motion.time;  // `motion` is a grid of the trial
  SINEW_ASSIGN(const MuscleGeometrySeries series, skeleton.muscles.Along(time, trajectory, skeleton.joints));
  trial.grids["lengths"] = ToGrid(time, muscles, series.lengths);
  for (std::size_t j = 0; j < joints.size(); ++j)
    trial.grids["moment_arms." + joints[j]] = ToGrid(time, muscles, series.moment_arms[j]);

  std::string said = fmt::format("{} frames: lengths of {} muscles, moment arms about {}\n", time.size(),
                                 muscles.size(), Join(joints, ", "));
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

Result<int> Muscles(const MusclesWords& words) {
  const std::string out = words.out.empty() ? words.path : words.out;
  if (!words.out.empty()) SINEW_TRY(CheckOutput(out, {words.path}));
  SINEW_ASSIGN(Dataset data, ReadDataset(words.path));
  if (!words.model.empty()) {
    SINEW_ASSIGN(data.files["model.osim"], ReadText(words.model));
  }
  const auto file = data.files.find("model.osim");
  if (file == data.files.end()) return Fail("{}: holds no model.osim: expected --model M.osim", words.path);
  SINEW_ASSIGN(const Skeleton skeleton,
               BuildSkeleton(file->second,
                             words.model.empty() ? words.path + "/files/model.osim" : words.model, words));
  std::string report;
  bool any = false;
  for (auto& [name, trial] : data.trials) {
    const Grid* motion = FindMotion(trial, *skeleton.model);
    if (motion == nullptr) {
      report += fmt::format("{}: holds no coordinate of the model, left as it is\n", name);
      continue;
    }
    any = true;
    const auto said = AddMuscles(skeleton, *motion, words.joints, trial);
    if (!said) return Fail("{}: trial '{}': {}", words.path, name, said.error().message);
    report += name + ": " + *said;
  }
  if (!any) {
    return Fail(
        "{}: no trial holds a coordinate of the model; import joint angles, or run `sinew data "
        "kinematics` on markers",
        words.path);
  }
  SINEW_TRY(WriteDataset(out, data));
  std::fputs(report.c_str(), stdout);
  return kDone;
}

}  // namespace

void AddMusclesCommand(Command data, const RunAction& run) {
  auto words = std::make_shared<MusclesWords>();
  Command command = data.AddCommand(
      "muscles",
      "Lengths and moment arms of a model's muscles along the joint angles (docs/muscle_geometry.md)");
  command.Add("file", words->path).Required().Shows("F.h5");
  command.Add("--model", words->model, "OpenSim model; default: model.osim inside the data set")
      .Shows("M.osim");
  command.Add("--muscles", words->muscles, "Default: all of the model")
      .Split(',')
      .Shows("soleus_r,med_gas_r");
  command.Add("--joints", words->joints, "Angles about which moment arms are wanted")
      .Split(',')
      .Required()
      .Shows("ankle_angle_r,knee_angle_r");
  command.Add("--out", words->out, "Data set to write; default: the same").Shows("G.h5");
  command.Runs(run, [=] { return Muscles(*words); });
}

}  // namespace sinew
