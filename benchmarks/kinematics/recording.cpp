#include "recording.h"

#include <algorithm>
#include <fstream>
#include <regex>
#include <sstream>
#include <stdexcept>

#include "base/constants.h"
#include "datasets/io/storage_file.h"
#include "datasets/io/trc_file.h"
#include "models/multibody/osim_reader.h"

namespace sinew::kinematics_study {
namespace {

template <typename T>
T Get(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().message);
  return std::move(*result);
}

std::string Text(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// "/jointset/hip_r/hip_flexion_r/value" is hip_flexion_r.
std::string PlainName(std::string name) {
  const std::string ending = "/value";
  if (name.size() > ending.size() && name.compare(name.size() - ending.size(), ending.size(), ending) == 0)
    name.resize(name.size() - ending.size());
  return name.substr(name.rfind('/') + 1);
}

}  // namespace

MultibodyModel Build(const OsimModel& model) {
  return Get(MultibodyModel::Build(model));
}

Recording ReadRecording(const std::string& folder, const RecordingFiles& files) {
  Recording recording;
  recording.name = files.name;
  recording.model = Get(ReadOsim(Text(folder + "/" + files.model), files.model));
  recording.setup = Get(ReadIkSetup(Text(folder + "/" + files.weights), files.weights));

  const TrcFile trc = Get(ReadTrc(folder + "/" + files.markers));
  recording.markers.times = trc.time;
  recording.markers.positions.resize(trc.time.size());
  for (const TrcMarker& marker : trc.markers) {
    recording.markers.names.push_back(marker.name);
    for (std::size_t i = 0; i < trc.time.size(); ++i)
      recording.markers.positions[i].emplace_back(marker.position.row(static_cast<Eigen::Index>(i)));
  }

  // One of the files announces more columns than it has.
  const std::string text =
      std::regex_replace(Text(folder + "/" + files.coordinates), std::regex("nColumns *= *[0-9]+\r?\n"), "");
  const Storage table = Get(ParseStorage(text, files.coordinates));
  const MultibodyModel model = Build(recording.model);
  recording.times = table.time;
  recording.values.resize(static_cast<Eigen::Index>(table.time.size()),
                          static_cast<Eigen::Index>(table.names.size()));
  for (std::size_t c = 0; c < table.names.size(); ++c) {
    const std::string name = PlainName(table.names[c]);
    recording.published.push_back(name);
    const double unit = table.in_degrees.value_or(false) && model.IsRotational(name) ? kPi / 180 : 1;
    for (std::size_t i = 0; i < table.time.size(); ++i)
      recording.values(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(c)) =
          unit * table.columns[c][i];
  }
  return recording;
}

double Cost(const MultibodyModel& model, const IkSetup& setup, const std::vector<std::string>& names,
            const std::vector<Vec3>& observed, const Vector& values) {
  const std::vector<Vec3> positions = Get(model.MarkerPositions(values));
  double sum = 0;
  for (const IkSetup::MarkerTask& task : setup.markers) {
    const auto in_data = std::find(names.begin(), names.end(), task.name);
    const auto& known = model.marker_names();
    const auto in_model = std::find(known.begin(), known.end(), task.name);
    if (!task.apply || in_data == names.end() || in_model == known.end()) continue;
    const Vec3& measured = observed[static_cast<std::size_t>(in_data - names.begin())];
    if (!measured.allFinite()) continue;
    const Vec3& placed = positions[static_cast<std::size_t>(in_model - known.begin())];
    sum += task.weight * (placed - measured).squaredNorm();
  }
  return sum;
}

Vector PublishedPose(const MultibodyModel& model, const Recording& recording, Eigen::Index row,
                     const Vector& others) {
  Vector pose = others;
  for (std::size_t c = 0; c < recording.published.size(); ++c) {
    const auto index = model.CoordinateIndex(recording.published[c]);
    if (index) pose[*index] = recording.values(row, static_cast<Eigen::Index>(c));
  }
  return pose;
}

MarkerTrajectories Resampled(const MarkerTrajectories& markers, const std::vector<double>& times) {
  MarkerTrajectories at;
  at.names = markers.names;
  at.times = times;
  for (const double time : times) {
    const auto after = std::upper_bound(markers.times.begin(), markers.times.end(), time);
    const auto last = static_cast<std::ptrdiff_t>(markers.times.size()) - 2;
    const auto i =
        static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(after - markers.times.begin() - 1, 0, last));
    const double share = (time - markers.times[i]) / (markers.times[i + 1] - markers.times[i]);
    at.positions.emplace_back();
    for (std::size_t m = 0; m < markers.names.size(); ++m)
      at.positions.back().emplace_back((1 - share) * markers.positions[i][m] +
                                       share * markers.positions[i + 1][m]);
  }
  return at;
}

}  // namespace sinew::kinematics_study
