// The load on a plate from a foot whose pose deviates from the recorded one, and whose sole may be lower or
// higher on the foot than drawn: kinematics are computed anew at every instant. Exact derivatives.
#pragma once

#include <vector>

#include "problems/contact/load/effect_load.h"
#include "problems/contact/motion/foot_motion.h"
#include "problems/contact/settings.h"

namespace sinew {

/// Derivatives of a ContactLoad for the values, then the rates, of a PoseDeviation.
using ContactPoseJacobian = Eigen::Matrix<double, 6, 2 * kPoseComponents>;

/// Derivatives of a ContactLoad for the place of a sole on the foot, by SolePlace.
using ContactPlaceJacobian = Eigen::Matrix<double, 6, kSolePlaces>;

/// Scratch of one thread and one stance; holds the kinematics of one instant.
class PosedFoot {
 public:
  /// @param recorded kinematics of the stance, whose areas and parts are kept
  explicit PosedFoot(const EffectKinematics& recorded);

  /// Places every spring. @param sole_place [parts][SolePlace, m] of the soles from where they are drawn
  /// @param side of the foot, see Stance
  void Place(const EffectKinematics& recorded, const FootMotion& foot, double floor_height, int instant,
             const PoseDeviation& deviation, const std::vector<Vec3>& sole_place, double side,
             bool derivatives);

  /// Kinematics of that instant, as instant 0: for ComputeEffectLoad.
  [[nodiscard]] const EffectKinematics& kinematics() const { return posed_; }

  /// The load without contact effects, after Place; sets `load` and, with derivatives, `by_part` of it. All
  /// of it in one pass over the springs: a quarter of the time of ComputeEffectLoad and Differentiate.
  /// @param beds [parts] @param by_pose, by_place [parts] set with derivatives, see Differentiate
  void ComputeLoad(const FootMotion& foot, const std::vector<ElasticFoundation>& beds, bool derivatives,
                   EffectLoad& load, ContactPoseJacobian& by_pose,
                   std::vector<ContactPlaceJacobian>& by_place) const;

  /// After Place with derivatives, and ComputeEffectLoad with EffectLoadQuery::springs.
  /// @param by_place [parts] set: a column per SolePlace
  void Differentiate(const FootMotion& foot, const EffectLoad& load, ContactPoseJacobian& by_pose,
                     std::vector<ContactPlaceJacobian>& by_place) const;

 private:
  /// Regions, then edges.
  [[nodiscard]] EffectRegion& Region(std::size_t index);
  [[nodiscard]] const EffectRegion& Region(std::size_t index) const;

  EffectKinematics posed_;
  std::vector<BodyMotion> motion_;       // [bodies]
  std::vector<PoseJacobian> jacobians_;  // [bodies]
  std::vector<Vec3> sole_place_;         // [parts]
  double side_ = 1;
  double floor_height_ = 0;
};

}  // namespace sinew
