// The markers on a foot: how far inverse kinematics left them from where they were measured, and where a
// deviation of the pose leaves them.
#pragma once

#include <string>
#include <vector>

#include "datasets/dataset.h"
#include "models/multibody/osim_model.h"
#include "problems/contact/motion/foot_motion.h"

namespace sinew {

struct FootMarkers {
  struct Marker {
    std::string name;
    std::size_t body = 0;          ///< index into FootMotion::bodies
    Vec3 location = Vec3::Zero();  ///< in its frame [m]
    std::vector<Vec3> measured;    ///< [T, m] NaN where it was not seen
  };
  std::vector<Marker> markers;

  /// The instants `first` to before `last`.
  [[nodiscard]] FootMarkers Part(std::size_t first, std::size_t last) const;
  /// Where the model has the marker less where it was measured, ground axes [m]; NaN where it was not seen.
  [[nodiscard]] static Vec3 Residual(const Marker& marker, const BodyMotion& body, std::size_t instant) {
    return body.position + body.rotation * marker.location - marker.measured[instant];
  }
};

/// Those of the model's markers on the foot's bodies that the trial has (channels NAME_x, NAME_y, NAME_z),
/// interpolated at the times. Empty if it has none.
[[nodiscard]] FootMarkers MeasuredMarkers(const Trial& trial, const OsimModel& model,
                                          const MultibodyModel& multibody, const FootMotion& foot,
                                          const std::vector<double>& times);

/// What the markers say about the accuracy of the foot's recorded pose.
struct MarkerAccuracy {
  int markers = 0;
  double residual = 0;  ///< root mean square distance between model and measurement [m]
  double position = 0;  ///< standard deviation along an axis [m]
  double rotation = 0;  ///< about an axis [rad]
};

/// A marker's residual along one axis counts as the error of the pose along it, and divided by the markers'
/// root mean square distance from their centre as the error of the angle: errors of skin markers are common
/// to a segment, so that their number does not reduce them (Leardini et al. 2005, Gait & Posture 21:212).
[[nodiscard]] MarkerAccuracy AccuracyOf(const FootMarkers& markers, const FootMotion& foot);

}  // namespace sinew
