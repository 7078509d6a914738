// The floor under one spring of a sole with contact effects, and how the parameters that move it do so.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "problems/contact/load/effect_load.h"

namespace sinew {

struct RaisedFace {
  double rise = 0;    // of the floor [m]
  double depth = 0;   // [m]
  double rate = 0;    // [m/s]
  double slip_x = 0;  // of the spring's lower end over the floor [m/s]
  double slip_z = 0;
  std::array<double, 2> velocity{};        // x, z of the foot there, in the frame of the ground [m/s]
  std::array<double, 2> lever{};           // x, z from the point that slopes leave alone
  std::array<double, kShapeModes> arms{};  // of the displacement upwards, by mode
};

// The floor as the sole meets it: its height and slope, and how the sole is displaced. A spring's depth is
// found first, and where it moves only for those that touch: most do not.
class FloorUnderSole {
 public:
  // @param shear_velocity see EffectLoadQuery
  FloorUnderSole(const EffectKinematics& kinematics, const ContactEffectValues& effects, int instant,
                 const std::array<double, 2>& shear_velocity = {})
      : kinematics_(kinematics),
        shear_velocity_(shear_velocity),
        height_(effects[kHeightOffset]),
        slope_{effects[kFloorSlopeX], effects[kFloorSlopeZ]},
        up_(1 / std::sqrt(1 + slope_[0] * slope_[0] + slope_[1] * slope_[1])) {
    if (kinematics.phase.empty()) return;
    share_ = kinematics.phase[static_cast<std::size_t>(instant)];
    for (std::size_t m = 0; m < kShapeModes; ++m) {
      for (std::size_t j = 0; j < kShapePhases; ++j) {
        const double value = effects[ShapeEffect(m, j)];
        mode_[m] += value * share_.value[j];
        mode_rate_[m] += value * share_.rate[j];
      }
    }
  }

  // False if no spring of the region can be as low as the floor at this instant.
  [[nodiscard]] bool CanTouch(const EffectRegion& region, int instant) const {
    if (sloped() || region.deepest.empty()) return true;
    const double most =
        height_ + (std::abs(mode_[kBend]) + std::abs(mode_[kPitch])) * region.reach + std::abs(mode_[kLift]);
    // Rounding of a spring's own sum must not lift it above this bound.
    constexpr double kRounding = 1e-12;  // [m]
    return region.deepest[static_cast<std::size_t>(instant)] + most > -kRounding;
  }

  // Rise, depth and arms. @tparam kShaped false: where displaced() is false; arms stay 0
  // @param i of the arrays of the kinematics: of face f
  template <bool kShaped>
  [[nodiscard]] RaisedFace DepthAt(const EffectRegion& region, std::size_t i, std::size_t f) const {
    RaisedFace face;
    face.rise = height_;
    if (sloped()) {
      SetLever(region, i, face);
      face.rise += slope_[0] * face.lever[0] + slope_[1] * face.lever[1];
    }
    if (kShaped && !region.ahead.empty()) {
      face.arms = ShapeArms(region.ahead[f]);
      face.rise -= mode_[kBend] * face.arms[kBend] + mode_[kPitch] * face.arms[kPitch] + mode_[kLift];
    }
    face.depth = (region.kinematics.depth[i] + face.rise) * up_;
    return face;
  }

  // The rest of a face that DepthAt has begun.
  // @tparam kMoves false: of a floor that is not sloped the rate alone, without slip and lever
  template <bool kShaped, bool kMoves>
  void AddMotion(const EffectRegion& region, int instant, std::size_t i, RaisedFace& face) const {
    const ContactKinematics& k = region.kinematics;
    double rate = k.rate[i];
    if constexpr (kMoves) {
      const auto t = static_cast<std::size_t>(instant);
      const double foot_x = k.slip_x[i] - region.turning_z[t] * face.rise;
      const double foot_z = k.slip_z[i] + region.turning_x[t] * face.rise;
      face.slip_x = foot_x + shear_velocity_[0];
      face.slip_z = foot_z + shear_velocity_[1];
      face.velocity = {foot_x + kinematics_.floor_velocity[0], foot_z + kinematics_.floor_velocity[1]};
      if (sloped()) {
        rate += slope_[0] * face.velocity[0] + slope_[1] * face.velocity[1];
      } else {
        SetLever(region, i, face);
      }
    }
    if (kShaped && !region.ahead.empty())
      rate -=
          mode_rate_[kBend] * face.arms[kBend] + mode_rate_[kPitch] * face.arms[kPitch] + mode_rate_[kLift];
    face.rate = rate * up_;
  }

  [[nodiscard]] bool sloped() const { return slope_[0] != 0 || slope_[1] != 0; }
  // Does the sole differ from the recorded one at this instant?
  [[nodiscard]] bool displaced() const {
    for (std::size_t m = 0; m < kShapeModes; ++m) {
      if (mode_[m] != 0 || mode_rate_[m] != 0) return true;
    }
    return false;
  }
  [[nodiscard]] double slope(std::size_t axis) const { return slope_[axis]; }
  [[nodiscard]] double up() const { return up_; }  // cosine of the slope
  [[nodiscard]] const PhaseShare& phase() const { return share_; }

 private:
  void SetLever(const EffectRegion& region, std::size_t i, RaisedFace& face) const {
    face.lever = {region.kinematics.point_x[i] - kinematics_.tilt_reference[0],
                  region.kinematics.point_z[i] - kinematics_.tilt_reference[1]};
  }

  const EffectKinematics& kinematics_;
  std::array<double, 2> shear_velocity_;
  double height_;
  std::array<double, 2> slope_;
  double up_;
  PhaseShare share_;
  std::array<double, kShapeModes> mode_{};
  std::array<double, kShapeModes> mode_rate_{};  // per second
};

}  // namespace sinew
