// Where a body is and how it moves at one instant.
#pragma once

#include "base/linear_algebra.h"

namespace sinew {

/// Motion of a body frame, all in ground axes.
struct BodyMotion {
  Vec3 position = Vec3::Zero();              ///< of the body's origin [m]
  Mat3 rotation = Mat3::Identity();          ///< turns body vectors into ground axes
  Vec3 velocity = Vec3::Zero();              ///< of the body's origin [m/s]
  Vec3 angular_velocity = Vec3::Zero();      ///< [rad/s]
  Vec3 acceleration = Vec3::Zero();          ///< of the body's origin [m/s2]
  Vec3 angular_acceleration = Vec3::Zero();  ///< [rad/s2]
};

}  // namespace sinew
