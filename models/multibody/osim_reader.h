// Reads the bodies, joints, couplers and markers of an OpenSim model file.
#pragma once

#include <string>
#include <string_view>

#include "models/multibody/osim_model.h"

namespace sinew {

/// Reads the text of an .osim file of OpenSim 2 or 3 (joints inside bodies) or 4 (a JointSet). Muscles,
/// geometry, contact and controllers are not looked at.
///
/// Supported: CustomJoint, PinJoint, WeldJoint, SliderJoint, UniversalJoint, BallJoint, GimbalJoint,
/// PlanarJoint, FreeJoint; axes that depend on one coordinate through Constant, LinearFunction, SimmSpline,
/// PiecewiseLinearFunction, PolynomialFunction, MultiplierFunction; CoordinateCouplerConstraint. Constraints
/// that the file switches off are left out.
///
/// @param file_name  for messages only. Errors, all as FILE:LINE: not XML, an unsupported joint, function or
/// constraint, a name that is missing or used twice, a number that cannot be read or is impossible.
Result<OsimModel> ReadOsim(std::string_view text, const std::string& file_name);

}  // namespace sinew
