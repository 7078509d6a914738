// Checks of a muscle's EMG: the cycles that a model must not be built from, with reasons.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/error.h"
#include "models/emg/cycles.h"
#include "models/emg/raw_emg.h"

namespace sinew {

enum class MuscleFault {
  kNoSignal,   ///< the envelope stays near zero, or never changes
  kSaturated,  ///< the envelope stays at the recording's maximum, or the raw signal is clipped
  kFrozen,     ///< the raw signal is constant: the transmission dropped out
  kGap,        ///< samples are missing
};

struct MuscleCheckSettings {
  /// No signal: the envelope's peak in the cycle is below this share of the median of all cycles' [0 .. 1).
  double weakest = 0.05;
  /// Shares of a cycle that may be saturated, or frozen, before it is left out [0 .. 1]. What is tolerated is
  /// still reported.
  double saturated = 0;
  double frozen = 0;
};

struct MuscleCycleFault {
  std::size_t cycle = 0;  ///< index
  MuscleFault fault = MuscleFault::kNoSignal;
  double share = 0;        ///< of the cycle's duration [0..1]
  bool tolerated = false;  ///< by the settings
};

struct MuscleCheck {
  bool silent = false;                   ///< no signal in any cycle: the muscle is unusable
  std::vector<MuscleCycleFault> faults;  ///< a cycle may have several
  std::vector<bool> usable;              ///< [cycles]
};

/// Errors: a setting outside of its range.
[[nodiscard]] Status CheckMuscleCheckSettings(const MuscleCheckSettings& settings);

/// Faults that the envelope shows. Saturated: equal to the largest value of all cycles for 20 ms and three
/// samples or more; low-passed signals are not flat that long unless they were limited. O(N + cycles).
/// @param time [N, s, increasing] @param envelope [N, any unit; NaN where there is a gap]
/// @param cycles in the order of time
/// @return Errors: sizes, settings, a cycle that the samples do not cover.
Result<MuscleCheck> CheckMuscle(const std::vector<double>& time, const std::vector<double>& envelope,
                                const std::vector<MovementCycle>& cycles,
                                const MuscleCheckSettings& settings);

/// Adds the faults of the raw signal, found by FindRawEmgFaults, to `check` of the same cycles.
/// @param first_s time of the raw signal's first sample [s] @param rate_Hz of it [Hz, > 0]
/// @param reach_s how far a fault spoils the envelope on both sides (UnsettledSeconds) [s, >= 0]
void AddRawFaults(const RawEmgFaults& faults, double first_s, double rate_Hz, double reach_s,
                  const std::vector<MovementCycle>& cycles, const MuscleCheckSettings& settings,
                  MuscleCheck& check);

[[nodiscard]] std::size_t CountUsable(const MuscleCheck& check);

/// One sentence for the cycles left out, one for the tolerated ones; none if there are no faults.
[[nodiscard]] std::vector<std::string> DescribeMuscleCheck(const std::string& muscle,
                                                           const std::vector<MovementCycle>& cycles,
                                                           const MuscleCheck& check);

}  // namespace sinew
