// What may be wrong with a bed of springs under a measured motion: the contact effects, their parameters and
// their null values. The physics of each is one line of contact_effect_load.cpp.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "problems/contact/phase_shape.h"
#include "problems/contact/stiffness_modes.h"
#include "problems/kit/parameter_list.h"

namespace sinew {

/// Parameters of the contact effects as a plate feels them. All are 0 at the null.
enum ContactEffect : std::size_t {
  kHeightOffset,       ///< of the kinematics [m]: the soles are lower than in the recorded motion
  kFloorCompliance,    ///< in series under the bed of springs [m3/N]
  kStiffnessExponent,  ///< n of p = k x0 (x / x0)^(1 + n), x0 = kReferenceDepth
  kFloorSlopeX,        ///< rise of the floor per metre along x [rad, small]
  kFloorSlopeZ,        ///< along z
  kUnmodelledMass,     ///< that moves with the foot's body, under the springs [kg]
  kToeRegion,          ///< weight of a strip in front of the sole [1]
  kHeelRegion,         ///< behind it
  kLinearDamping,      ///< d: a pressure d v beside that of the springs [N s/m3]
  kShearCompliance,    ///< of the sole, horizontally [m/N]
  kStiffnessMode,      ///< the first of kStiffnessModes [1, logarithms of ratios]
  kFirstShape = kStiffnessMode + kStiffnessModes,  ///< the first of those of ShapeEffect: [rad], [rad], [m]
  kLastShape = kFirstShape + kShapeModes * kShapePhases - 1,
  kContactEffects  ///< how many
};

/// Of a mode at one of its phases.
constexpr std::size_t ShapeEffect(std::size_t mode, std::size_t phase) {
  return kFirstShape + mode * kShapePhases + phase;
}

/// One value per ContactEffect.
using ContactEffectValues = std::array<double, kContactEffects>;

/// x0 of the stiffness exponent [m]: there the pressure of the bent law equals that of the straight one.
constexpr double kReferenceDepth = 1e-3;

/// Where the effects of a problem stand among its parameters: ContactEffect after ContactEffect, shared by
/// all stances; then, if there is more than one plate, a height offset per plate (PLATE.height_offset), which
/// adds to the shared one.
class ContactEffectList {
 public:
  ContactEffectList() = default;
  /// @param first index of the first effect parameter; @param plates their names.
  ContactEffectList(int first, std::vector<std::string> plates);

  /// Appends the effects with their parameters, in the order above.
  void Declare(ParameterListBuilder& add) const;

  /// Columns of a block of this plate, increasing: one per ContactEffect, then the plate's own height offset
  /// if plates have one.
  [[nodiscard]] std::vector<int> ColumnsOf(const std::string& plate) const;
  /// Index of PLATE.height_offset, -1 if there is but one plate.
  [[nodiscard]] int OwnHeight(const std::string& plate) const;
  [[nodiscard]] int first() const { return first_; }
  /// Index after the last one.
  [[nodiscard]] int end() const {
    return first_ + static_cast<int>(kContactEffects) + static_cast<int>(plates_.size());
  }

 private:
  int first_ = 0;
  std::vector<std::string> plates_;  // empty if there is but one
};

}  // namespace sinew
