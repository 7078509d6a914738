// What is true in the laboratory: the base parameters of a drive, the effects of the library, and effects
// that are not in it.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/error.h"
#include "models/drive/drive.h"
#include "problems/synthesis_request.h"

namespace sinew {

/// Further places of a truth, after those of the joint's law (DriveSlot), in SI and rotary.
enum DriveTruthSlot : int {
  // The position reading, in the order of SensorEffect.
  kPositionOffset = kDriveSlots,
  kPositionDrift,
  kPositionGain,
  kPositionTimeOffset,
  kPositionLowPass,
  kPositionSaturation,
  kPositionQuantisation,
  // Outsiders: no effect of the library is any of these.
  kWearRate,           ///< [N*m/rad] Coulomb torque per distance travelled
  kTightSpotTorque,    ///< [N*m] Coulomb torque at kTightSpotPosition, a bell of its width
  kTightSpotPosition,  ///< [rad]
  kTightSpotWidth,     ///< [rad]
  kShiftRate,          ///< [N*m/s] growth of the gravity torque
  kHysteresisTorque,   ///< [N*m] of a Dahl element
  kHysteresisWidth,    ///< [rad] travel after which it has turned over
  kClockRate,          ///< [1] the recorder's clock is slow by this fraction
  kDampingRate,        ///< [N*m/rad] growth of the viscous friction per second
  kStopStiffness,      ///< [N*m/rad] of an elastic stop beyond kStopPosition
  kStopPosition,       ///< [rad]
  kHumTorque,          ///< [N*m] periodic in time
  kHumFrequency,       ///< [Hz]
  kHumPhase,           ///< [rad]
  kBumpTorque,         ///< [N*m] bell of position
  kBumpPosition,       ///< [rad]
  kBumpWidth,          ///< [rad]
  kCommandStep,        ///< [N*m] the drive's torque is rounded to multiples of it
  kLostLoad,           ///< [1] share of inertia and gravity that falls off at kLostTime
  kLostTime,           ///< [s]
  kCubicDrag,          ///< [N*m*s3/rad3]
  kEccentricity,       ///< [rad] reading + eccentricity sin(2 q + phase)
  kEccentricityPhase,  ///< [rad]
  kDriveTruthSlots
};

/// Numbers of the simulated drive by DriveSlot and DriveTruthSlot. What the library's slots mean is written
/// in its list (`sinew list effects drive`); the laboratory's own laws are at SimulateDrive. Those of the
/// joint's state and of unknown terms are not used.
class DriveTruth {
 public:
  /// A joint in which nothing is hidden: gains are 1, and what only shapes something has its usual value.
  DriveTruth();

  [[nodiscard]] double operator[](int slot) const { return values_[static_cast<std::size_t>(slot)]; }
  double& operator[](int slot) { return values_[static_cast<std::size_t>(slot)]; }

 private:
  std::array<double, kDriveTruthSlots> values_{};
};

/// A parameter of a hidden effect, its name, and where it is stored.
struct DriveTruthEntry {
  std::string effect;
  std::string parameter;
  std::string unit;
  int slot = 0;
  double lower = 0;
  double upper = 0;
  /// Outsiders: on what the truth depends: "position", "velocity", "command", "time", "periodic in time",
  /// "two signals", "history". Empty for the effects of the library.
  std::string depends_on;
};

/// All of them; those of one effect are neighbours. The effects are those that a fitted model of such data
/// has, the sensor of position included; ranges reach from those of the smallest joint that is fitted to
/// those of the largest. @param input the input channel ("torque" or "reference"), which names its sensor's
/// effects
[[nodiscard]] std::vector<DriveTruthEntry> DriveTruthEntries(const std::string& input);

/// Writes the parameters of `--effect NAME:PARAM=VALUE,...` into a truth. Errors: those of ReadHiddenEffects.
Status HideEffects(const RequestedEffects& effects, const std::string& input, DriveTruth& truth);

}  // namespace sinew
