// One foot on one force plate during one trial: the kinematics of its soles, prepared for any parameters.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "models/contact/contact_sums.h"
#include "models/multibody/coordinate_trajectory.h"
#include "models/multibody/multibody_model.h"
#include "problems/contact/load/effect_load.h"
#include "problems/contact/motion/foot_markers.h"
#include "problems/contact/motion/foot_motion.h"
#include "problems/contact/motion/marker_pose.h"
#include "problems/contact/motion/motion_errors.h"
#include "problems/contact/settings.h"
#include "problems/contact/steps/body_load.h"

namespace sinew {

struct Stance {
  std::string trial;
  std::string plate;
  std::vector<double> time;  ///< [T, s]
  struct Part {
    int group = 0;  ///< index into ContactSettings::Groups()
    ContactSums sums;
  };
  std::vector<Part> parts;
  EffectKinematics kinematics;          ///< every face, touching or not
  FootMotion foot;                      ///< the same springs, to be moved
  FootMarkers markers;                  ///< only with motion errors
  PoseNoise pose_noise;                 ///< of `foot`, by these markers
  StanceMotionErrors motion_errors;     ///< no components: none
  std::optional<BodyLoad> body;         ///< only with motion errors
  std::vector<int> regions;             ///< [kinematics.regions] index of each into ContactSettings::regions
  std::array<double, 2> middle{};       ///< x, z [m] of the springs where the sole is deepest
  std::array<double, 2> resting_cop{};  ///< x, z [m]: used as the centre of pressure without contact
  double side = 1;                      ///< 1, -1: of the model's two feet, by the side of its middle
  Vec3 forward = Vec3::UnitX();         ///< horizontal direction of the foot in the middle of the stance
  Vec3 progression = Vec3::UnitX();     ///< horizontal direction in which the body walks (FindProgression)
  std::array<double, 2> recorded{};     ///< first and last instant while the plate records [s]
  std::array<double, 2> loaded{};       ///< from when to when the plate is loaded [s]
  bool fitted = false;                  ///< its trial is a training trial
  bool measured = true;                 ///< false: no plate measured a vertical force
  double greatest_force = 0;            ///< measured vertically [N]; else the mean of the measured stances
  double length = 0;                    ///< of the sole, between its outermost springs along x or z [m]
  std::array<int, 6> blocks{};          ///< index into the layout of each of kContactChannels

  /// First and last instant while the plate records.
  [[nodiscard]] std::array<std::size_t, 2> RecordedInstants() const;
  /// Sets `forward` to where the foot points at an instant.
  void LookForward(std::size_t instant);
};

/// @param bodies of settings.regions, as indices of the model. The strips that missing_toe_region and
/// missing_heel_region add lie in front of the foremost and behind the hindmost region, seen along the x axis
/// of the first region's body where the sole is deepest; each is a fifth of the distance between the two ends
/// long. Errors: those of MultibodyModel::BodyMotions.
Result<Stance> MakeStance(const std::string& trial, const std::string& plate, std::vector<double> time,
                          const CoordinateTrajectory& motion, const MultibodyModel& model,
                          const std::vector<int>& bodies, const ContactSettings& settings);

}  // namespace sinew
