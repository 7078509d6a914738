#include "models/contact/pose_deviation.h"

#include <Eigen/Geometry>

namespace sinew {
namespace {

Mat3 Cross(const Vec3& v) {
  Mat3 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

// a = (1 - cos r) / r^2 and b = (r - sin r) / r^3 with their derivatives over r, divided by r: by their power
// series, which have no difficulty at 0 and converge to rounding for every r below pi.
struct TurnSeries {
  double a = 0;
  double b = 0;
  double a_slope = 0;
  double b_slope = 0;

  explicit TurnSeries(double square) {
    constexpr int kTerms = 16;
    double power = 1;           // (-r^2)^k / (2k + 2)! and, over (2k + 3), / (2k + 3)!
    double power_slope = -1.0;  // (-1)^k r^(2k - 2) / (2k + 2)!
    double factorial = 2;
    for (int k = 0; k < kTerms; ++k) {
      a += power / factorial;
      b += power / (factorial * (2 * k + 3));
      if (k > 0) {
        a_slope += 2 * k * power_slope / factorial;
        b_slope += 2 * k * power_slope / (factorial * (2 * k + 3));
        power_slope *= -square;
      }
      power *= -square;
      factorial *= (2.0 * k + 3) * (2.0 * k + 4);
    }
  }
};

}  // namespace

FootTurn::FootTurn(const PoseDeviation& deviation) {
  const Vec3 r(deviation.value[kTurnX], deviation.value[kTurnY], deviation.value[kTurnZ]);
  const Vec3 rate(deviation.rate[kTurnX], deviation.rate[kTurnY], deviation.rate[kTurnZ]);
  const TurnSeries series(r.squaredNorm());
  const Mat3 cross = Cross(r);
  const Mat3 square = cross * cross;
  // exp([r]x) = 1 + (sin r / r) [r]x + a [r]x^2, with sin r / r = 1 - b r^2.
  rotation_ = Mat3::Identity() + (1 - series.b * r.squaredNorm()) * cross + series.a * square;
  left_jacobian_ = Mat3::Identity() + series.a * cross + series.b * square;
  angular_velocity_ = left_jacobian_ * rate;
  const Vec3 once = r.cross(rate);
  const Vec3 twice = r.cross(once);
  by_turn_ = (series.a_slope * once + series.b_slope * twice) * r.transpose() - series.a * Cross(rate) -
             series.b * (Cross(once) + cross * Cross(rate));
}

BodyMotion DeviatedMotion(const PoseDeviation& deviation, const FootTurn& turn, const BodyMotion& body,
                          const JointAxis& axis, const Vec3& centre, const Vec3& centre_velocity,
                          PoseJacobian* jacobian) {
  // About the joint's axis, which both bodies carry.
  const Vec3 arm = body.position - axis.point;
  const Mat3 hinge = axis.direction.isZero()
                         ? Mat3(Mat3::Identity())
                         : Eigen::AngleAxisd(deviation.value[kJointAngle], axis.direction).toRotationMatrix();
  const Vec3 turned_arm = hinge * arm;
  const Vec3 bent_spin = body.angular_velocity + deviation.rate[kJointAngle] * axis.direction;
  const Vec3 point_velocity = body.velocity - body.angular_velocity.cross(arm);
  const Vec3 bent_position = axis.point + turned_arm;
  const Vec3 bent_velocity = point_velocity + bent_spin.cross(turned_arm);

  // About the centre, and shifted.
  const Vec3 shift(deviation.value[kShiftX], deviation.value[kShiftY], deviation.value[kShiftZ]);
  const Vec3 shift_rate(deviation.rate[kShiftX], deviation.rate[kShiftY], deviation.rate[kShiftZ]);
  const Mat3& rotation = turn.rotation();
  const Vec3& spin = turn.angular_velocity();
  const Vec3 lever = rotation * (bent_position - centre);
  const Vec3 own_velocity = rotation * (bent_velocity - centre_velocity);
  const Vec3 own_spin = rotation * bent_spin;
  BodyMotion moved = body;
  moved.position = centre + shift + lever;
  moved.rotation = rotation * hinge * body.rotation;
  moved.angular_velocity = own_spin + spin;
  moved.velocity = centre_velocity + shift_rate + spin.cross(lever) + own_velocity;
  if (jacobian == nullptr) return moved;

  jacobian->setZero();
  for (int axis_of = 0; axis_of < 3; ++axis_of) {
    const Vec3 unit = Vec3::Unit(axis_of);
    jacobian->col(kShiftX + axis_of).segment<3>(0) = unit;
    jacobian->col(kPoseComponents + kShiftX + axis_of).segment<3>(6) = unit;

    const Vec3 by_turn = turn.left_jacobian().col(axis_of);
    const Vec3 spin_by_turn = turn.angular_velocity_by_turn().col(axis_of);
    auto value = jacobian->col(kTurnX + axis_of);
    value.segment<3>(0) = by_turn.cross(lever);
    value.segment<3>(3) = by_turn;
    value.segment<3>(6) =
        spin_by_turn.cross(lever) + spin.cross(by_turn.cross(lever)) + by_turn.cross(own_velocity);
    value.segment<3>(9) = by_turn.cross(own_spin) + spin_by_turn;
    auto rate = jacobian->col(kPoseComponents + kTurnX + axis_of);
    rate.segment<3>(6) = by_turn.cross(lever);
    rate.segment<3>(9) = by_turn;
  }
  const Vec3 swing = axis.direction.cross(turned_arm);
  auto value = jacobian->col(kJointAngle);
  value.segment<3>(0) = rotation * swing;
  value.segment<3>(3) = rotation * axis.direction;
  value.segment<3>(6) = spin.cross(rotation * swing) + rotation * bent_spin.cross(swing);
  auto rate = jacobian->col(kPoseComponents + kJointAngle);
  rate.segment<3>(6) = rotation * swing;
  rate.segment<3>(9) = rotation * axis.direction;
  return moved;
}

}  // namespace sinew
