// Reads the paths of muscles of an OpenSim model file.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "models/multibody/osim_muscle_path.h"

namespace sinew {

/// The names of everything in the ForceSet that has a GeometryPath (muscles of any type, ligaments, path
/// actuators), in the file's order. Errors: not an OpenSim model file; two of one name.
Result<std::vector<std::string>> ListOsimMuscles(std::string_view text, const std::string& file_name);

/// A muscle whose path has something that ReadOsimMuscles refuses: a wrap object or point of another kind.
struct UnsupportedMuscle {
  std::string muscle;
  std::string part;  ///< type and name of it: "WrapEllipsoid 'egg'"
  long line = 0;     ///< of it
};

/// Those of `muscles` that cannot be read because something on their paths is not supported. Other faults,
/// and muscles that the file lacks, are left to ReadOsimMuscles. Errors: not an OpenSim model file.
Result<std::vector<UnsupportedMuscle>> ListUnsupportedMuscles(std::string_view text,
                                                              const std::string& file_name,
                                                              const OsimModel& model,
                                                              const std::vector<std::string>& muscles);

/// Reads the paths of some muscles of an .osim file of OpenSim 2, 3 or 4; the other muscles are not looked
/// at.
///
/// Supported: PathPoint, ConditionalPathPoint, MovingPathPoint (its components as every function that
/// ReadOsim reads); PathWrap over WrapCylinder and WrapSphere, with quadrant, range, rotation and
/// translation. Objects that the file switches off are left out. The method of a PathWrap (hybrid, midpoint,
/// axial) means something for ellipsoids only.
///
/// @param text, file_name  the file that `model` was read from; the name is for messages only.
/// @param muscles  in the order wanted.
/// Errors, all but the first as FILE:LINE: a muscle that the file lacks, with the name that was probably
/// meant; a body, coordinate or wrap object that does not exist; a wrap object or path of another kind; a
/// number that cannot be read or is impossible; a path with fewer than two points. Where several muscles have
/// something that is not supported, the error names them all.
Result<std::vector<OsimMusclePath>> ReadOsimMuscles(std::string_view text, const std::string& file_name,
                                                    const OsimModel& model,
                                                    const std::vector<std::string>& muscles);

}  // namespace sinew
