// Parameters and effects of the ankle on a dynamometer, by the places of its equations.
#pragma once

#include <vector>

#include "models/dynamometer/strapped_foot.h"
#include "problems/ankle_on_dynamometer/settings.h"
#include "problems/kit/parameter_list.h"

namespace sinew {

enum AnkleSlot {
  // robot
  kAttachmentInertia,
  kAttachmentGravity,
  kAttachmentGravityAngle,
  kAttachmentFriction,
  kDryFriction,
  kOneWayFriction,
  kFrictionWithLoad,
  kAttachmentStiffness,
  kLastOfAttachment = kAttachmentStiffness,
  // boundary
  kSoleStiffness,
  kSoleDissipation,
  kSoleCompression,
  kSoleExponent,
  kSoleFriction,
  kStrapStiffness,
  kStrapExponent,
  kStrapPretension,
  kStrapDamping,
  kStrapLoosening,  ///< by which the straps grow longer per second of a trial [m/s]
  kAxisX,
  kAxisY,
  kBoundaryRelaxation,
  kBoundaryRelaxationTime,
  // human
  kPassiveStiffness,
  kPassiveExponent,
  kPassiveAngle,
  kPassiveLinear,
  kPassiveDamping,
  kPassiveHysteresis,
  kPassiveRelaxation,
  kPassiveRelaxationTime,
  kAnkleShape,
  kAnkleFilterTime,
  kAnkleDelay,
  kFatigue,          ///< share by which the active force falls per second of excitation 1 [1/s]
  kUnseenDrive,      ///< excitation that no electrode saw [1]
  kEmgCrossTalk,     ///< share of the other muscles' mean excitation in the measured one [1]
  kAntagonist,       ///< moment of an unmeasured muscle per mean excitation [N m]
  kStretchForce,     ///< ForceHistory's enhancement [1]
  kShorteningForce,  ///< its depression [1]
  kMomentTerm,       ///< unknown moment at each knot of each signal [N m]
  kActiveMomentTerm =
      kMomentTerm + static_cast<int>(MomentSignal::kActivation) * static_cast<int>(kMomentKnots),
  kAnkleSlots = kMomentTerm + static_cast<int>(kMomentSignals * kMomentKnots)
};
/// Beyond kAnkleSlots, of each muscle.
enum AnkleMuscleSlot {
  kAnkleStrength,
  kAnkleSlackLength,
  kAnkleOptimalLength,
  kActivationTerm,  ///< unknown share of its activation at each knot of each signal [1]
  kAnkleMuscleSlots = kActivationTerm + static_cast<int>(kActivationSignals * kActivationKnots)
};

[[nodiscard]] inline int SlotOfMuscle(std::size_t muscle, AnkleMuscleSlot slot) {
  return kAnkleSlots + static_cast<int>(muscle) * kAnkleMuscleSlots + slot;
}
/// @param slot from kAnkleSlots on
[[nodiscard]] inline int PlaceInMuscle(int slot) {
  return (slot - kAnkleSlots) % kAnkleMuscleSlots;
}

/// A value for every slot of a problem with these settings that no parameter has.
[[nodiscard]] std::vector<double> AnkleDefaults(const AnkleSettings& settings);

/// Errors: a change of a parameter that does not exist (with a suggestion), or that makes no range.
Result<ParameterList> ListAnkleParameters(const AnkleSettings& settings);

/// The equations' numbers from values by slot. @param values [slots] T is double or Dual
template <class T>
[[nodiscard]] StrappedFoot<T> FootOf(const AnkleSettings& settings, const std::vector<T>& values);

}  // namespace sinew
