// Lengths, moment arms and lengthening velocities of muscles from their paths over a moving skeleton.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "models/multibody/coordinate_trajectory.h"
#include "models/multibody/multibody_model.h"
#include "models/multibody/osim_muscle_path.h"

namespace sinew {

struct TracedMuscle;

/// Muscles at one time.
struct MuscleGeometryState {
  Vector lengths;      ///< [muscles, m], of muscle and tendon
  Vector velocities;   ///< [muscles, m/s], dl/dt, > 0 while the muscle lengthens
  Matrix moment_arms;  ///< [muscles x coordinates asked for, m (N m per N), or 1 for a coordinate in m]
  /// Muscles (indices) whose path over several objects alternates between two solutions; the values are those
  /// of one of them.
  std::vector<int> unsettled;
};

/// Muscles along a motion.
struct MuscleGeometrySeries {
  Matrix lengths;                   ///< [times x muscles, m]
  Matrix velocities;                ///< [times x muscles, m/s]
  std::vector<Matrix> moment_arms;  ///< [coordinates asked for] [times x muscles, m]
  std::vector<int>
      unsettled;  ///< [muscles] number of times at which the path did not converge, see the state
};

/// The paths of some muscles of a model. It does not change after it is built, and every const member may be
/// called from many threads at once.
///
/// The moment arm of a coordinate q is r = -dl/dq, positive where the muscle's pull drives q upwards. It is
/// the total derivative: coordinates that couplers make depend on q move along, and so do moving points. It
/// is exact: for a path of straight pieces between corners, dl is the sum over the pieces of their unit
/// vectors times the difference of their ends' motions; where a piece ends on a wrap surface, the end moves
/// with the surface's body, because the length is stationary with respect to shifts of the tangent points
/// (and the arc between them is rigid). At a value of the coordinate where a conditional point joins the path
/// or leaves it the length may jump; the moment arm is that of the path as it is there.
///
/// Source of the behaviour: OpenSim 4's GeometryPath; Sherman, Seth, Delp 2013, "What is a moment arm?",
/// doi:10.1115/DETC2013-13633. Departures: paths over several objects are iterated until the length changes
/// by less than 1e-12 m (OpenSim: 5e-4 m).
class MuscleGeometry {
 public:
  /// @param model  outlives this. Errors: a body or coordinate that the model lacks.
  static Result<MuscleGeometry> Build(const MultibodyModel& model,
                                      const std::vector<OsimMusclePath>& muscles);

  MuscleGeometry(MuscleGeometry&&) noexcept;
  MuscleGeometry& operator=(MuscleGeometry&&) noexcept;
  ~MuscleGeometry();

  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }

  /// @param values, rates  [coordinates of the model, rad or m, and per s]; dependent ones follow from their
  /// couplers. @param coordinates  indices of those whose moment arms are wanted.
  /// Errors: a vector of another size or not finite; a coordinate that does not exist or depends on another
  /// one; fewer than two points of a path are active.
  [[nodiscard]] Result<MuscleGeometryState> At(const Vector& values, const Vector& rates,
                                               const std::vector<int>& coordinates) const;

  /// The same along a trajectory. @param times  [s].
  [[nodiscard]] Result<MuscleGeometrySeries> Along(const std::vector<double>& times,
                                                   const CoordinateTrajectory& trajectory,
                                                   const std::vector<int>& coordinates) const;

 private:
  MuscleGeometry(const MultibodyModel& model, std::vector<TracedMuscle> muscles);

  const MultibodyModel* model_;
  std::vector<TracedMuscle> muscles_;
  std::vector<std::string> names_;
};

}  // namespace sinew
