// Phase of a movement within its cycle, from the angle and its direction alone, as needed in real time.
#pragma once

#include <cstddef>
#include <vector>

#include "base/error.h"

namespace sinew {

/// The inverse of a mean angle over a cycle that begins and ends at one turning point and reverses once.
class PhaseOfAngle {
 public:
  /// @param angle mean over cycles, warped [K >= 3, rad or any unit]; small wiggles are levelled: on the way
  /// to the reversal an angle counts when it is reached first.
  /// @return Errors: fewer than 3 samples, a value that is not finite, an angle that does not change or has
  /// no turning point within the cycle.
  static Result<PhaseOfAngle> Fit(const std::vector<double>& angle);

  /// @param angle [unit of the mean angle]; beyond the range of the mean: the turning point
  /// @param before_reversal the movement is on its way from the beginning to the reversal
  /// @return phase for AtPhase and AveragedEmg::At [0..1]. O(log K).
  [[nodiscard]] double At(double angle, bool before_reversal) const;

  /// Phase of the reversal.
  [[nodiscard]] double reversal() const { return reversal_; }

 private:
  PhaseOfAngle() = default;
  double sign_ = 1;  // 1: the angle rises to the reversal
  double reversal_ = 0;
  double step_ = 0;            // of phase between samples
  std::vector<double> there_;  // from the beginning to the reversal, never falling
  std::vector<double> back_;   // from the end to the reversal, never falling
};

}  // namespace sinew
