// The weights of markers and coordinates in an OpenSim inverse kinematics setup file.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace sinew {

struct IkSetup {
  struct MarkerTask {
    std::string name;
    bool apply = true;
    double weight = 1;  ///< >= 0
  };
  /// What a coordinate is drawn to.
  enum class Target { kDefaultValue, kManualValue, kFromFile };
  struct CoordinateTask {
    std::string name;
    bool apply = true;
    double weight = 1;  ///< >= 0
    Target target = Target::kDefaultValue;
    double value = 0;  ///< for kManualValue [rad or m]
  };

  std::vector<MarkerTask> markers;
  std::vector<CoordinateTask> coordinates;
  double start_time = -std::numeric_limits<double>::infinity();  ///< [s]
  double end_time = std::numeric_limits<double>::infinity();     ///< [s]
};

/// Reads the text of a setup file of OpenSim's InverseKinematicsTool, or of a saved IKTaskSet. OpenSim's
/// accuracy and constraint weight are not needed: ours is finer, and constraints always hold exactly. Errors,
/// as FILE:LINE: not XML, no tasks, a task of another kind, a weight that is negative or not finite.
Result<IkSetup> ReadIkSetup(std::string_view text, const std::string& file_name);

}  // namespace sinew
