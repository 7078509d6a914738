// A mechanism as a Simbody system. For the files of this folder only; it includes Simbody's headers.
#pragma once

#include <Simbody.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/linear_algebra.h"

namespace sinew {

struct MechanismSystem {
  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter{system};
  SimTK::GeneralForceSubsystem forces{system};
  SimTK::State state;  ///< at t = 0, on the constraints
  /// The coordinates that are compared, of a state realized to Position.
  std::function<Vector(const SimTK::State&)> coordinates;
  /// Work of non-conservative forces on the mechanism since t = 0 [J], of a state realized to Velocity;
  /// empty: none.
  std::function<double(const SimTK::State&)> work;
};

/// A uniform slender rod from the body's origin to `end`.
[[nodiscard]] SimTK::MassProperties SlenderRod(double mass, const SimTK::Vec3& end);

std::unique_ptr<MechanismSystem> BuildPendulum();
/// @param windows N >= 1 @param formulation loops, couplers or merged
std::unique_ptr<MechanismSystem> BuildWindows(int windows, const std::string& formulation);
/// @param ivp_start the angles of the IVP test set instead of beta = -0.0620
std::unique_ptr<MechanismSystem> BuildAndrews(bool ivp_start);
/// @param formulation closed-by-hinge or closed-by-ball
std::unique_ptr<MechanismSystem> BuildBricard(const std::string& formulation);
std::unique_ptr<MechanismSystem> BuildGovernor();

}  // namespace sinew
