// Muscle lengths that OpenSim computed along measured gait, and the motion that belongs to them.
#pragma once

#include <algorithm>
#include <cmath>

#include "models/multibody/muscle_geometry.h"
#include "models/multibody/osim_muscle_reader.h"
#include "tests/models/multibody/motion_files.h"

namespace sinew {

inline const std::string kMuscleLengths = kSharedData + "/muscle_lengths_opensim/";

/// "/jointset/hip_r/hip_flexion_r/value" -> "hip_flexion_r"; "/forceset/soleus_r|length" -> "soleus_r".
inline std::string PlainName(const std::string& column) {
  std::string name = column.substr(0, column.find('|'));
  const std::string value = "/value";
  if (name.size() > value.size() && name.compare(name.size() - value.size(), value.size(), value) == 0)
    name.resize(name.size() - value.size());
  return name.substr(name.find_last_of('/') + 1);
}

/// A column of a motion file without its header's decoration.
inline std::vector<std::string> PlainNames(const Motion& motion) {
  std::vector<std::string> names;
  for (std::size_t i = 1; i < motion.names.size(); ++i) names.push_back(PlainName(motion.names[i]));
  return names;
}

/// Everything that a comparison needs.
struct MuscleReference {
  explicit MuscleReference(const std::string& model_name, const std::string& motion_name,
                           const std::string& lengths_name)
      : text(ReadText(kMuscleLengths + model_name)), model(BuildModel(text)) {
    const Motion motion = ReadMot(kMuscleLengths + motion_name);
    coordinates = PlainNames(motion);
    values.resize(static_cast<Eigen::Index>(motion.rows.size()),
                  static_cast<Eigen::Index>(coordinates.size()));
    for (std::size_t row = 0; row < motion.rows.size(); ++row) {
      times.push_back(motion.rows[row][0]);
      for (std::size_t c = 0; c < coordinates.size(); ++c) {
        const double unit = model.IsRotational(coordinates[c]) ? std::acos(-1.0) / 180 : 1;
        values(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(c)) = unit * motion.rows[row][c + 1];
      }
    }
    if (lengths_name.empty()) return;
    const Motion given = ReadMot(kMuscleLengths + lengths_name);
    muscles = PlainNames(given);
    lengths.resize(static_cast<Eigen::Index>(given.rows.size()), static_cast<Eigen::Index>(muscles.size()));
    for (std::size_t row = 0; row < given.rows.size(); ++row) {
      length_times.push_back(given.rows[row][0]);
      for (std::size_t m = 0; m < muscles.size(); ++m)
        lengths(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(m)) = given.rows[row][m + 1];
    }
  }

  [[nodiscard]] CoordinateTrajectory Trajectory() const {
    auto fitted = CoordinateTrajectory::Fit(model, times, coordinates, values);
    if (!fitted) throw std::runtime_error(fitted.error().message);
    return std::move(*fitted);
  }

  [[nodiscard]] std::vector<OsimMusclePath> Paths() const {
    auto read = ReadOsimMuscles(text, "test.osim", *ReadOsim(text, "test.osim"), muscles);
    if (!read) throw std::runtime_error(read.error().message);
    return std::move(*read);
  }

  std::string text;
  MultibodyModel model;
  std::vector<double> times;
  std::vector<std::string> coordinates;
  Matrix values;  // [times x coordinates, rad or m]
  std::vector<std::string> muscles;
  std::vector<double> length_times;
  Matrix lengths;  // [length_times x muscles, m]
};

}  // namespace sinew
