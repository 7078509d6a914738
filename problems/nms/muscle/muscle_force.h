// The force of one muscle through a trial, from its excitation and the length of its unit. SCIENCE section 3.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "base/error.h"
#include "models/muscle/activation.h"
#include "models/muscle/hill_muscle.h"

namespace sinew {

/// What the force of a muscle depends on, by place.
enum MuscleSlot {
  kFilterMean,    ///< time of the filter [s]; as CEINMS has it: mean of C1 and C2 at the rate of the lengths
  kFilterSpread,  ///< of its poles [0..1): FilterOfTimes, FilterOfCoefficients
  kShape,         ///< A
  kDelay,         ///< electromechanical [s]
  kOptimalLength,
  kTendonSlackLength,
  kIsometricForce,
  kStrength,
  kPennation,
  kLengthChange,
  kDamping,
  kLargestVelocity,
  kSubjectSlots,             ///< those above are a muscle's in the subject file; those below rest at 0
  kEmgGain = kSubjectSlots,  ///< excitation beyond the measured one, as a share [1, > -1]
  kEmgDrift,                 ///< share by which the excitation is larger per second of the trial [1/s]
  kCoContraction,            ///< excitation beyond the measured one [1]
  kCrossTalk,                ///< share of the other muscles' mean excitation in the measured one [1]
  kEnhancement,              ///< of the force, per optimal length of stretch: ForceHistory [1]
  kDepression,               ///< of the force, per optimal length of shortening: ForceHistory [1]
  kTendonCompliance,  ///< strain of the tendon beside that of the subject's curve; of a rigid tendon only [1,
                      ///< >= 0]
  kAngleOffset,       ///< first of kMaxJoints: of the joint's true angle beyond the measured one [rad]
  kMuscleSlots = kAngleOffset + 3
};
/// That a muscle may cross.
constexpr int kMaxJoints = kMuscleSlots - kAngleOffset;

enum class TendonMode {
  kRigid,
  kEquilibrium,  ///< elastic; the fibre's velocity from a spline through its lengths
  kElastic       ///< elastic; the fibre's length integrated
};

struct MuscleModel {
  TendonMode tendon = TendonMode::kRigid;
  ActivationShape shape = ActivationShape::kExponential;
  /// As CEINMS computes it, down to the habits that change numbers: the filter runs at the rate of the
  /// lengths once they begin, delays are whole samples, and with an elastic tendon the velocity is that of
  /// another pass whose filter drops the value before the last.
  bool as_ceinms = false;
};

/// What is measured of one muscle in one trial.
struct MuscleSignals {
  std::vector<double> excitation_time;    ///< [M >= 2, s, increasing]
  std::vector<double> excitation;         ///< [M, 0..1]
  std::vector<double> others;             ///< [M] mean of the other muscles' excitations; empty: 0
  int number_of_others = 1;               ///< of these muscles [>= 1]
  std::vector<double> time;               ///< [N >= 2, s, increasing] of lengths and forces
  std::vector<double> unit_length;        ///< [N, m] of muscle and tendon
  std::vector<std::vector<double>> arms;  ///< [joints <= kMaxJoints] [N, m] = -d unit_length / d angle
  /// [joints] [N, m/rad] d arm / d angle of the same joint; 0 where it is not known
  std::vector<std::vector<double>> arm_slopes;
  /// SplineEndWeights of `time`, for TendonMode::kEquilibrium; null: computed each time.
  std::shared_ptr<const std::vector<double>> end_weights;
};

/// The moment arm at the joint's true angle, which is `offset` [rad] beyond the measured one [m].
template <class T>
[[nodiscard]] T ArmAt(const MuscleSignals& signals, std::size_t joint, std::size_t frame, const T& offset) {
  return signals.arms[joint][frame] + signals.arm_slopes[joint][frame] * offset;
}

/// By which the unit is shorter at the joint's true angle than at the measured one [m].
template <class T>
[[nodiscard]] T ShorteningAt(const MuscleSignals& signals, std::size_t joint, std::size_t frame,
                             const T& offset) {
  return (signals.arms[joint][frame] + 0.5 * signals.arm_slopes[joint][frame] * offset) * offset;
}

/// Everything that a prediction may show, at each instant.
template <class T>
struct MuscleTrace {
  std::vector<T> activation;      ///< [N]
  std::vector<T> fibre_length;    ///< [N, m]
  std::vector<T> fibre_velocity;  ///< [N, m/s]
  std::vector<T> tendon_force;    ///< [N, N]; of a rigid tendon the fibre's force along it
};

/// Fibre lengths in equilibrium of one muscle and trial, of the parameters that they were found for: where
/// the same are asked again, with derivatives, nothing is searched. One per workspace.
struct FoundLengths {
  std::array<double, kMuscleSlots> parameters{};
  std::array<std::vector<double>, 2> lengths;  ///< [passes][N, m]; empty: none
};

/// What few parameters move needs few derivatives: Dual<N> for these N.
constexpr int kFewLanes = 4;
constexpr int kSomeLanes = 8;

/// Instantiated for double, Dual<kFewLanes>, Dual<kSomeLanes> and Dual<kMuscleSlots>.
/// @param found of the same muscle and trial; may be null. Errors: no equilibrium of fibre and tendon, with
/// the time.
template <class T>
Status ComputeMuscleForce(const MuscleCurves& curves, const MuscleModel& model,
                          const std::array<T, kMuscleSlots>& parameters, const MuscleSignals& signals,
                          MuscleTrace<T>& trace, FoundLengths* found = nullptr);

}  // namespace sinew
