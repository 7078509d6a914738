// The loads of the ground as OpenSim reads them: a table of forces, and an ExternalLoads setup.
#pragma once

#include <string>
#include <vector>

#include "datasets/ground_loads.h"
#include "datasets/io/external_loads.h"
#include "datasets/io/storage_file.h"

namespace sinew {

/// Columns PLATE_ground_force_vx (force), PLATE_ground_force_px (point) and PLATE_ground_torque_x, with y and
/// z. `sinew data import --plates PLATE=PLATE_ground_` reads them again.
[[nodiscard]] Storage ForceTable(const GroundLoads& loads);

/// The columns of ForceTable that act on a body. @param body name in the model: "calcn_r"
[[nodiscard]] ExternalForce ForceOn(const std::string& plate, const std::string& body);

/// An OpenSim document (version 30000, which OpenSim 3 and 4 read) of these forces.
/// @param table name of the file with their columns, from the folder of the document
[[nodiscard]] std::string ExternalLoadsText(const std::vector<ExternalForce>& forces,
                                            const std::string& table);

}  // namespace sinew
