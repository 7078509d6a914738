// A published recording with its model, marker weights and published coordinates.
#pragma once

#include <string>
#include <vector>

#include "models/multibody/ik_setup.h"
#include "models/multibody/inverse_kinematics.h"
#include "models/multibody/osim_model.h"

namespace sinew::kinematics_study {

/// Names of files of one folder.
struct RecordingFiles {
  std::string name;
  std::string model;
  std::string markers;
  std::string weights;
  std::string coordinates;
};

struct Recording {
  std::string name;
  OsimModel model;
  IkSetup setup;
  MarkerTrajectories markers;
  std::vector<double> times;           ///< of the published coordinates [s]
  std::vector<std::string> published;  ///< their names
  Matrix values;                       ///< [times x published, rad or m]
};

/// Throws std::runtime_error with the reader's message.
Recording ReadRecording(const std::string& folder, const RecordingFiles& files);

MultibodyModel Build(const OsimModel& model);

/// sum w |m(q) - o|^2 over the markers of the setup that are present [m2].
double Cost(const MultibodyModel& model, const IkSetup& setup, const std::vector<std::string>& names,
            const std::vector<Vec3>& observed, const Vector& values);

/// The published coordinates at a row; those that were not published are taken from `others`.
Vector PublishedPose(const MultibodyModel& model, const Recording& recording, Eigen::Index row,
                     const Vector& others);

/// The markers at other instants, linear in between.
MarkerTrajectories Resampled(const MarkerTrajectories& markers, const std::vector<double>& times);

}  // namespace sinew::kinematics_study
