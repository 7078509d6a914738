#include "problems/contact/laboratory/stepping_robot.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace sinew {
namespace {

// Geometry of nao_like.osim [m].
constexpr double kThigh = 0.1;
constexpr double kShank = 0.1029;
constexpr double kHipOffset = 0.05;
constexpr double kSoleHeight = 0.04519;
constexpr double kHeel = -0.06;
constexpr double kToe = 0.10;

Mat3 AboutX(double angle) {
  return Eigen::AngleAxisd(angle, Vec3::UnitX()).toRotationMatrix();
}
Mat3 AboutZ(double angle) {
  return Eigen::AngleAxisd(angle, Vec3::UnitZ()).toRotationMatrix();
}

// From 0 to 1 over [begin, end] with three continuous derivatives, so that 60 samples a second can follow it.
double Rise(double t, double begin, double end) {
  const double s = std::clamp((t - begin) / (end - begin), 0.0, 1.0);
  return s * s * s * s * (35 + s * (-84 + s * (70 - 20 * s)));
}

// Integral of Rise over time, so that a speed profile has its distance.
double RiseIntegral(double t, double begin, double end) {
  const double s = std::clamp((t - begin) / (end - begin), 0.0, 1.0);
  const double inside = (end - begin) * s * s * s * s * s * (7 + s * (-14 + s * (10 - 2.5 * s)));
  return inside + std::max(0.0, t - end);
}

struct FootPose {
  Vec3 ankle;
  Mat3 rotation;
};

FootPose StanceFoot(const Step& step, double t, double side) {
  const double T = step.duration;
  const double pitch =
      step.strike_pitch * (1 - Rise(t, -0.06, 0.22)) - step.push_off_pitch * Rise(t, T - 0.24, T + 0.10);
  const double roll = step.roll * std::sin(2 * M_PI * t / T);
  const Mat3 rotation = AboutZ(pitch) * AboutX(roll);

  // Depth of the point that rolls along the sole from heel to toe; negative in the air.
  const double phase = (t - 0.5 * T) / (0.5 * T);
  const double depth =
      step.depth * (1 - std::abs(phase * phase * phase) +
                    step.rocking * std::cos(4 * M_PI * t / T) * (1 - Rise(std::abs(phase), 0.4, 1.6)));
  const double rolling = step.size * (0.5 * (kHeel + kToe) - 0.5 * (kToe - kHeel) * std::tanh(pitch / 0.06));
  const double height = -depth - rolling * std::sin(pitch) + step.size * kSoleHeight * std::cos(pitch);

  // Sliding: forward after the strike, backward at push-off; swinging fast before and after.
  const double swing_speed = 0.25 * step.size;
  const double forward =
      -swing_speed * RiseIntegral(-t, 0.03, 0.18) + swing_speed * RiseIntegral(t, T + 0.03, T + 0.18) +
      step.slip_speed * (std::min(t, 0.0) + (std::max(t, 0.0) - RiseIntegral(t, 0.0, 0.2))) -
      step.slip_speed * RiseIntegral(t, T - 0.2, T);
  const double sideways = 0.02 * step.slip_speed * T * std::sin(2 * M_PI * t / T + 0.5);
  return {Vec3(forward, height, step.size * side * kHipOffset + sideways), rotation};
}

// The foot where it is not.
FootPose Misplaced(const FootPose& foot, double size, const FootError& error) {
  const double angle = error.turn.norm();
  const Mat3 turn =
      angle > 0 ? Eigen::AngleAxisd(angle, error.turn / angle).toRotationMatrix() : Mat3(Mat3::Identity());
  const Vec3 arm = foot.rotation * Vec3(0.5 * size * (kHeel + kToe), -size * kSoleHeight, 0);
  return {foot.ankle + arm + error.shift - turn * arm, turn * foot.rotation};
}

FootPose SwingFoot(const Step& step, double t, double side) {
  const double s = std::clamp((t + 0.25) / (step.duration + 0.5), 0.0, 1.0);
  const double lift = 0.022 + 0.008 * std::sin(M_PI * s);
  return {step.size * Vec3(0.035 * std::cos(M_PI * (1 - s)), kSoleHeight + lift, side * kHipOffset),
          Mat3::Identity()};
}

// Closed-form inverse kinematics of one leg: hip (flexion about z, adduction about x, rotation about y), knee
// about z, ankle about z and x. `side` is +1 for the right leg.
Status LegAngles(const Vec3& pelvis, const Mat3& pelvis_rotation, double size, const FootPose& foot,
                 double side, std::map<std::string, double>& pose) {
  const std::string suffix = side > 0 ? "_r" : "_l";
  const double thigh = size * kThigh;
  const double shank = size * kShank;
  const Vec3 hip = pelvis + pelvis_rotation * Vec3(0, 0, side * size * kHipOffset);
  const Vec3 r = foot.rotation.transpose() * (hip - foot.ankle);
  const double sigma = std::atan2(-r.z(), r.y());
  const double along = r.x();
  const double up = std::hypot(r.y(), r.z());
  const double cosine = (along * along + up * up - thigh * thigh - shank * shank) / (2 * thigh * shank);
  if (!(cosine > -1 && cosine < 1))
    return Fail("the {} leg cannot reach its foot", side > 0 ? "right" : "left");
  const double knee = -std::acos(cosine);
  const double ankle =
      std::atan2(shank + thigh * std::cos(knee), thigh * std::sin(knee)) - std::atan2(up, along);
  const Mat3 hip_rotation =
      pelvis_rotation.transpose() * foot.rotation * AboutX(-sigma) * AboutZ(-ankle) * AboutZ(-knee);
  pose["hip_flexion" + suffix] = std::atan2(-hip_rotation(0, 1), hip_rotation(1, 1));
  pose["hip_adduction" + suffix] = side * std::asin(std::clamp(hip_rotation(2, 1), -1.0, 1.0));
  pose["hip_rotation" + suffix] = side * std::atan2(-hip_rotation(2, 0), hip_rotation(2, 2));
  pose["knee_angle" + suffix] = knee;
  pose["ankle_angle" + suffix] = ankle;
  pose["subtalar_angle" + suffix] = side * sigma;
  return {};
}

}  // namespace

Result<std::map<std::string, double>> SteppingPose(const Step& step, double t, const FootError& error) {
  const double stance_side = step.right ? 1 : -1;
  const double T = step.duration;
  const double sway = step.size * 0.012 * stance_side * std::cos(M_PI * (t - 0.5 * T) / (2 * T));
  const double tilt = 0.02 * std::sin(2 * M_PI * t / T);
  const double list = 0.015 * stance_side * std::cos(M_PI * (t - 0.5 * T) / T);
  const double height = step.size * (step.pelvis_height + 0.002 * std::cos(4 * M_PI * t / T));
  const Vec3 pelvis(step.walking_speed * (t - 0.5 * T), height, sway);
  const Mat3 pelvis_rotation = AboutZ(tilt) * AboutX(list);

  std::map<std::string, double> pose{{"pelvis_tilt", tilt},     {"pelvis_list", list},
                                     {"pelvis_rotation", 0},    {"pelvis_tx", pelvis.x()},
                                     {"pelvis_ty", pelvis.y()}, {"pelvis_tz", pelvis.z()}};
  const FootPose stance = StanceFoot(step, t, stance_side);
  const bool misplaced = !(error.shift.isZero(0) && error.turn.isZero(0));
  SINEW_TRY(LegAngles(pelvis, pelvis_rotation, step.size,
                      misplaced ? Misplaced(stance, step.size, error) : stance, stance_side, pose));
  SINEW_TRY(
      LegAngles(pelvis, pelvis_rotation, step.size, SwingFoot(step, t, -stance_side), -stance_side, pose));
  const double swing = 0.3 * std::sin(M_PI * t / T);
  pose["head_yaw"] = 0.05 * std::sin(2 * M_PI * t / T);
  pose["arm_flex_r"] = -stance_side * swing;
  pose["arm_flex_l"] = stance_side * swing;
  for (const char* suffix : {"_r", "_l"}) {
    pose[std::string("arm_add") + suffix] = -0.15;
    pose[std::string("elbow_flex") + suffix] = 0.5 + 0.1 * swing;
  }
  return pose;
}

}  // namespace sinew
