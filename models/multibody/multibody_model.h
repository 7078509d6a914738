// A body tree with joints, couplers and markers: positions and motions of bodies for given coordinates.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "models/multibody/body_motion.h"
#include "models/multibody/osim_model.h"

namespace sinew {

class CoordinateTrajectory;
struct SimbodyModel;

/// An OpenSim model as a Simbody system. It does not change after it is built, and every const member may be
/// called from many threads at once.
///
/// Coordinates are in the file's order of joints, in rad or m; their rates are plain time derivatives. The
/// value of a coordinate that a coupler makes dependent always follows from the coupler, whatever is passed
/// for it.
class MultibodyModel {
 public:
  /// Errors: a body with no joint or with two, joints or couplers in a circle, names that do not exist,
  /// masses that no body can have.
  static Result<MultibodyModel> Build(const OsimModel& model);

  MultibodyModel(MultibodyModel&&) noexcept;
  MultibodyModel& operator=(MultibodyModel&&) noexcept;
  ~MultibodyModel();

  [[nodiscard]] const std::string& name() const;
  [[nodiscard]] const std::vector<std::string>& coordinate_names() const;
  /// Ground first, then the file's bodies.
  [[nodiscard]] const std::vector<std::string>& body_names() const;
  [[nodiscard]] const std::vector<std::string>& marker_names() const;
  [[nodiscard]] double total_mass_kg() const;
  /// Sentences on what was changed to make the model physically possible.
  [[nodiscard]] const std::vector<std::string>& notes() const;

  /// Errors: no such body or coordinate, with the closest name.
  [[nodiscard]] Result<int> BodyIndex(std::string_view name) const;
  [[nodiscard]] Result<int> CoordinateIndex(std::string_view name) const;
  /// @param index  0 .. number of coordinates - 1.
  [[nodiscard]] const OsimCoordinate& coordinate(int index) const;
  /// Whether the coordinate is an angle, which motion files may give in degrees; false for an unknown name.
  [[nodiscard]] bool IsRotational(std::string_view name) const;
  /// True for a rotational coordinate and for a coupled one from which a rotation follows: its unit is rad.
  [[nodiscard]] bool IsAngle(std::string_view name) const;
  /// Whether the coordinate depends on others by a coupler.
  [[nodiscard]] bool IsDependent(int index) const;
  /// Whether the coordinate moves a body directly against ground.
  [[nodiscard]] bool IsGroundCoordinate(int index) const;
  /// [coordinates], with couplers satisfied.
  [[nodiscard]] const Vector& default_values() const;

  /// @param values, rates  [coordinates, rad or m, and per s]; @param bodies  indices from BodyIndex;
  /// @param accelerations  [coordinates, per s2], zero when empty. @return one motion for each of `bodies`.
  /// Errors: a vector of another size or not finite, a body index that does not exist.
  [[nodiscard]] Result<std::vector<BodyMotion>> BodyMotionAt(const Vector& values, const Vector& rates,
                                                             const std::vector<int>& bodies,
                                                             const Vector& accelerations = {}) const;

  /// The prescribed motion of bodies along a trajectory: [times][bodies]. Errors as for BodyMotionAt.
  [[nodiscard]] Result<std::vector<std::vector<BodyMotion>>> BodyMotions(
      const std::vector<double>& times, const CoordinateTrajectory& trajectory,
      const std::vector<int>& bodies) const;

  /// Ground positions [m] of all markers, as marker_names(). Errors: `values` has another size or is not
  /// finite.
  [[nodiscard]] Result<std::vector<Vec3>> MarkerPositions(const Vector& values) const;

  /// The Simbody objects; for the sources of models/ (models/multibody/simbody_model.h).
  [[nodiscard]] const SimbodyModel& simbody() const;

 private:
  struct Impl;
  explicit MultibodyModel(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;
};

}  // namespace sinew
