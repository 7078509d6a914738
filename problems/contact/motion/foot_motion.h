// The recorded motion of a foot's bodies and springs, ready to be deviated from at every instant.
#pragma once

#include <vector>

#include "base/error.h"
#include "models/contact/elastic_foundation.h"
#include "models/contact/pose_deviation.h"
#include "models/multibody/coordinate_trajectory.h"
#include "models/multibody/multibody_model.h"

namespace sinew {

/// One foot during one stance.
struct FootMotion {
  struct Body {
    std::vector<BodyMotion> motion;  ///< [T] as recorded
    std::vector<JointAxis> axis;     ///< [T] between the first body and this one
  };
  /// Springs of a region in the frame of its body.
  struct Springs {
    int body = 0;                  ///< index into `bodies`
    std::vector<Vec3> position;    ///< [faces, m]
    Mat3 axes = Mat3::Identity();  ///< of the region: forward, from the sole into the foot, to its right
    /// Where they move if the sole lies elsewhere, by SolePlace [m]. @param side 1, -1 of a left foot
    [[nodiscard]] Vec3 Moved(const Vec3& place, double side) const {
      return axes * Vec3(place.x(), place.y(), side * place.z());
    }
  };
  std::vector<int> indices;      ///< [bodies] of the model
  std::vector<Body> bodies;      ///< the first one carries the foot's centre
  std::vector<Springs> springs;  ///< [regions of the stance, then its edges]
  Vec3 centre_B = Vec3::Zero();  ///< mean of the springs, in the frame of the first body [m]
  std::vector<Vec3> centre;      ///< [T, m, ground]
  std::vector<Vec3> centre_velocity;
  /// The centre: where the sole is on average, at this instant's angle of the foot's joint.
  void SetCentre(std::size_t instant);
  /// Moves everything up. @param height [m]
  void Raise(double height);
  /// Computes `centre` and `centre_velocity` from `centre_B` and the first body's motion.
  void PlaceCentre();
  /// The instants `first` to before `last`.
  [[nodiscard]] FootMotion Part(std::size_t first, std::size_t last) const;
  /// Takes over the motion of such a part; before and after it the foot is moved as at its ends.
  void TakeOver(const FootMotion& part, std::size_t first);
  bool has_joint = false;  ///< a body beyond the first moves about one axis
};

/// A region of the foot and its body in the model.
struct FootRegion {
  const ContactRegion* region = nullptr;
  int body = 0;  ///< index of the model
};

/// @param regions of the stance, then strips beyond its ends; the body that the model names first is the
/// foot's first one. Errors: those of MultibodyModel::BodyMotions.
Result<FootMotion> RecordedFootMotion(const std::vector<double>& times, const CoordinateTrajectory& motion,
                                      const MultibodyModel& model, const std::vector<FootRegion>& regions);

/// Motion of a body of the foot under a deviation; `turn` is that of the deviation.
[[nodiscard]] BodyMotion DeviatedBody(const FootMotion& foot, std::size_t body, std::size_t instant,
                                      const PoseDeviation& deviation, const FootTurn& turn,
                                      PoseJacobian* jacobian);

}  // namespace sinew
