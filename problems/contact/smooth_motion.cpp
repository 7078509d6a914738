#include "problems/contact/smooth_motion.h"

#include <Eigen/Geometry>
#include <Eigen/QR>

#include "problems/contact/motion_errors.h"

namespace sinew {
namespace {

Vec3 RotationVector(const Mat3& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

}  // namespace

void SmoothMotion(const std::vector<double>& times, double cutoff, FootMotion& foot) {
  const MotionErrorBasis splines = MotionErrorBasis::Splines(times, times.front(), times.back(), cutoff);
  if (splines.value.cols() >= splines.value.rows()) return;  // slower sampling has no such frequencies
  const Eigen::ColPivHouseholderQR<Matrix> fit(splines.value);
  const FootMotion recorded = foot;
  const std::size_t middle = times.size() / 2;
  for (std::size_t b = 0; b < foot.bodies.size(); ++b) {
    std::vector<BodyMotion>& motion = foot.bodies[b].motion;
    const Mat3 reference = motion[middle].rotation;
    Matrix pose(static_cast<Eigen::Index>(times.size()), 6);
    for (std::size_t t = 0; t < times.size(); ++t) {
      pose.row(static_cast<Eigen::Index>(t)) << motion[t].position.transpose(),
          RotationVector(motion[t].rotation * reference.transpose()).transpose();
    }
    const Matrix weights = fit.solve(pose);
    const Matrix value = splines.value * weights;
    const Matrix rate = splines.rate * weights;
    for (std::size_t t = 0; t < times.size(); ++t) {
      const auto row = static_cast<Eigen::Index>(t);
      PoseDeviation turn;
      for (int axis = 0; axis < 3; ++axis) {
        const auto component = static_cast<std::size_t>(kTurnX + axis);
        turn.value[component] = value(row, 3 + axis);
        turn.rate[component] = rate(row, 3 + axis);
      }
      const FootTurn rotation(turn);
      motion[t].position = value.row(row).head<3>();
      motion[t].velocity = rate.row(row).head<3>();
      motion[t].rotation = rotation.rotation() * reference;
      motion[t].angular_velocity = rotation.angular_velocity();
    }
  }
  for (std::size_t b = 0; b < foot.bodies.size(); ++b) {
    for (std::size_t t = 0; t < times.size(); ++t) {
      const BodyMotion& from = recorded.bodies.front().motion[t];
      const BodyMotion& to = foot.bodies.front().motion[t];
      const Mat3 turn = to.rotation * from.rotation.transpose();
      JointAxis& axis = foot.bodies[b].axis[t];
      axis.direction = turn * axis.direction;
      axis.point = to.position + turn * (axis.point - from.position);
    }
  }
  foot.PlaceCentre();
}

}  // namespace sinew
