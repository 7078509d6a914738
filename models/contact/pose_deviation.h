// A foot whose pose differs from the recorded one: skin markers locate a foot within millimetres and degrees,
// a force plate resolves much less. The exact motion of its bodies under a deviation, and derivatives.
#pragma once

#include <array>
#include <vector>

#include "base/linear_algebra.h"
#include "models/multibody/body_motion.h"

namespace sinew {

/// Components of a deviation: three of position and three of a rotation vector, all in ground axes, then the
/// angle of the joint in the middle of the foot (the toes' joint), for the bodies beyond it.
enum PoseComponent { kShiftX, kShiftY, kShiftZ, kTurnX, kTurnY, kTurnZ, kJointAngle, kPoseComponents };

/// A deviation at one instant, and its rate.
struct PoseDeviation {
  std::array<double, kPoseComponents> value{};  ///< [m, rad]
  std::array<double, kPoseComponents> rate{};   ///< [m/s, rad/s]
};

/// The axis of the joint between the foot's first body and another one, at one instant.
struct JointAxis {
  Vec3 direction = Vec3::Zero();  ///< unit vector in ground axes; zero: the body moves with the first one
  Vec3 point = Vec3::Zero();      ///< on the axis [m]
};

/// Derivatives of the motion of a body: rows are position, rotation (as a small rotation vector in ground
/// axes), velocity and angular velocity; columns the values, then the rates of PoseComponent.
using PoseJacobian = Eigen::Matrix<double, 12, 2 * kPoseComponents>;

/// The rotation of a deviation, R = exp([r]x), with its left Jacobian J: a change dr of the rotation vector
/// turns the foot by J dr. Source: Sola, Deray, Atchuthan (2018), A micro Lie theory, arXiv 1812.01537, eq.
/// 145.
class FootTurn {
 public:
  explicit FootTurn(const PoseDeviation& deviation);

  [[nodiscard]] const Mat3& rotation() const { return rotation_; }
  [[nodiscard]] const Mat3& left_jacobian() const { return left_jacobian_; }
  /// J dr/dt [rad/s]
  [[nodiscard]] const Vec3& angular_velocity() const { return angular_velocity_; }
  /// d angular_velocity / dr [3 x 3]
  [[nodiscard]] const Mat3& angular_velocity_by_turn() const { return by_turn_; }

 private:
  Mat3 rotation_;
  Mat3 left_jacobian_;
  Vec3 angular_velocity_;
  Mat3 by_turn_;
};

/// The motion of one of the foot's bodies under a deviation: turned about the joint's axis by the joint's
/// angle, then about the foot's centre by the rotation vector, then shifted. Exact for any size.
///
/// The acceleration is left as it is.
/// @param turn of the same deviation @param body as recorded @param axis of its joint
/// @param centre a point that moves with the foot's first body as recorded, and its velocity
/// @param jacobian nullptr, or filled
[[nodiscard]] BodyMotion DeviatedMotion(const PoseDeviation& deviation, const FootTurn& turn,
                                        const BodyMotion& body, const JointAxis& axis, const Vec3& centre,
                                        const Vec3& centre_velocity, PoseJacobian* jacobian);

}  // namespace sinew
