// OpenSim's ExternalLoads: which columns of a force file act on which body.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace sinew {

/// One force. An identifier is the part of a column's name before x, y, z: "ground_force_v" for
/// "ground_force_vx".
struct ExternalForce {
  std::string name;
  std::string applied_to_body;
  std::string force_identifier;   ///< never empty
  std::string point_identifier;   ///< empty if the file does not give the point of application
  std::string torque_identifier;  ///< empty if the file gives no torque
};

/// Reads the forces of an ExternalLoads XML (OpenSim 3 and 4) that are switched on.
/// Errors, with the line: not XML, no ExternalForce, a force without name, body or identifier, a name that
/// appears twice, a force or point that is not expressed in ground.
Result<std::vector<ExternalForce>> ReadExternalLoads(const std::string& path);

/// ReadExternalLoads for a text in memory. @param file the name that errors show.
Result<std::vector<ExternalForce>> ParseExternalLoads(std::string_view text, const std::string& file);

}  // namespace sinew
