// Which bodies of a model hang on which, and which one is the same on the other side.
#pragma once

#include <optional>
#include <vector>

#include "models/multibody/multibody_model.h"
#include "models/multibody/osim_model.h"

namespace sinew {

/// A body of the other side that corresponds to one of this side.
struct MirroredBody {
  int body = 0;                    ///< index of the model
  Mat3 mirror = Mat3::Identity();  ///< takes a point of this side's body frame to the other's; det -1
};

/// Bodies are indices of the model: ground is 0.
class BodyTree {
 public:
  static Result<BodyTree> Of(const OsimModel& model, const MultibodyModel& multibody);

  /// The body that it hangs on; -1 of ground.
  [[nodiscard]] int parent(int body) const { return parents_[static_cast<std::size_t>(body)]; }
  /// Joints between it and ground.
  [[nodiscard]] int depth(int body) const;
  /// The first body between ground and this one: mostly the pelvis.
  [[nodiscard]] int Root(int body) const;
  /// From the body outwards, always to the heaviest of the bodies that hang on the last one.
  [[nodiscard]] std::vector<int> Outwards(int body) const;
  /// Whether `other` is the body, or between it and ground, or hangs on it.
  [[nodiscard]] bool SameLimb(int body, int other) const;

  /// The bodies of the other side that correspond to a limb's end (Outwards of its first body): as far from
  /// ground, as many bodies, of the same mass and at the same distance from the root, when all coordinates
  /// are zero. Nothing if there is none. Names play no part.
  [[nodiscard]] std::optional<std::vector<MirroredBody>> OtherSide(int body) const;

 private:
  BodyTree() = default;

  std::vector<int> parents_;
  std::vector<double> masses_;    // [kg]
  std::vector<BodyMotion> zero_;  // poses with all coordinates zero
};

}  // namespace sinew
