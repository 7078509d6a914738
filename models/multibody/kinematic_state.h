// The scratch space in which a model's kinematics are computed; one per thread. Internal to models/.
#pragma once

#include <vector>

#include "models/multibody/coordinate_trajectory.h"
#include "models/multibody/multibody_model.h"
#include "models/multibody/simbody_model.h"

namespace sinew {

/// Errors: not `size` numbers, or one that is not finite. @param what  "values".
Status CheckCoordinateVector(const Vector& vector, std::size_t size, const char* what);

/// Sets every dependent coordinate to the value of its coupler.
void ApplyCouplers(const SimbodyModel& model, Vector& values);
/// The same for values, rates and accelerations.
void ApplyCouplers(const SimbodyModel& model, CoordinateState& coordinates);

/// Works on a copy of the system's state. Vectors passed in have the model's number of coordinates.
class KinematicState {
 public:
  /// The model's topology is realized; the model outlives this.
  explicit KinematicState(const SimbodyModel& model);

  Result<std::vector<BodyMotion>> Motions(CoordinateState coordinates, const std::vector<int>& bodies);
  Result<std::vector<Vec3>> MarkerPositions(Vector values);

  /// Places the bodies; for values whose couplers are already applied.
  void SetValues(const Vector& values);
  /// The same with the failure as a value.
  Status Place(const Vector& values);
  /// Positions and rotations of bodies that exist, placed as they are; the motion is zero.
  [[nodiscard]] std::vector<BodyMotion> Poses(const std::vector<int>& bodies) const;
  /// Sets the velocities of `motions`, one for each of `bodies`, for rates whose couplers are applied.
  void SetVelocities(const Vector& rates, const std::vector<int>& bodies,
                     std::vector<BodyMotion>& motions) const;
  [[nodiscard]] Vec3 MarkerPosition(std::size_t marker) const;
  /// d marker positions / d coordinates [3 x markers, coordinates], every coordinate taken as free.
  [[nodiscard]] Matrix MarkerJacobian(const std::vector<std::size_t>& markers) const;

 private:
  const SimbodyModel& model_;
  SimTK::State state_;
  std::vector<SimTK::QIndex> q_index_;                 // of each coordinate; u and udot have the same
  std::vector<std::vector<int>> coordinates_of_body_;  // by MobilizedBodyIndex
};

}  // namespace sinew
