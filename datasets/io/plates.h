// Which columns of a force file belong to which force plate.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace sinew {

/// A plate named by what its columns begin with: right = ground_ for ground_force_vx, ground_force_px,
/// ground_torque_x.
struct PlatePrefix {
  std::string plate;
  std::string prefix;
};

/// The parts before x, y, z of a plate's column names; point and torque may be empty.
struct PlateColumns {
  std::string plate;
  std::string force;
  std::string point;
  std::string torque;
};

/// Reads "right=ground_,left=1_ground_". Errors: no '=', an empty name or prefix, a plate that appears twice.
Result<std::vector<PlatePrefix>> ParsePlates(std::string_view text);

/// The columns that the prefix means. A column begins with the prefix: `ground_` is not `1_ground_`.
/// Understood are PREFIXforce_v*, PREFIXforce_p*, PREFIXtorque_* (or moment), and prefixes that reach
/// further: `ground_force_`, `ground_force_1_`, `ground_force_v`.
/// @return nothing if `names` holds no force of that plate. Errors: the prefix fits two sets of columns.
Result<std::optional<PlateColumns>> FindPlateColumns(const PlatePrefix& prefix,
                                                     const std::vector<std::string>& names);

/// Whether names holds identifier + x, y and z.
[[nodiscard]] bool HasAxes(const std::string& identifier, const std::vector<std::string>& names);

}  // namespace sinew
