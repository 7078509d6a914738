// Cycles of a periodic movement, found in a recorded angle. SCIENCE section 5: plantar-dorsiflexion at
// constant speeds on a dynamometer; strides of walking as well.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/error.h"

namespace sinew {

/// One movement from a turning point through the opposite one to the next of the same kind.
struct MovementCycle {
  double begin_s = 0;     ///< [s]
  double reversal_s = 0;  ///< [s], the opposite turning point
  double end_s = 0;       ///< [s], where the next cycle begins
  double speed = 0;       ///< mean absolute speed [unit of the angle / s]

  [[nodiscard]] double duration_s() const { return end_s - begin_s; }
};

enum class CycleBegin {
  kHighest,  ///< where the angle is highest
  kLowest,   ///< where it is lowest: maximum plantarflexion, if dorsiflexion is positive
};

struct CycleSettings {
  CycleBegin begins_at = CycleBegin::kHighest;
  /// What counts as a turn: the angle comes back by this share of its range (2nd to 98th percentile of the
  /// samples). More than half leaves out the second peak of an ankle in walking [0.05 .. 0.9].
  double swing = 0.6;
  /// Of two beginnings that lie nearer than this the more extreme one counts [s, >= 0; 0: all count].
  double shortest_s = 0;
  /// A cycle's duration may differ from the recording's median by this share of it [> 0].
  double duration_tolerance = 0.25;
  double longest_gap_s = 0;  ///< missing samples that a cycle may contain: bridged by a line [s, >= 0]
};

enum class CycleFault {
  kIncomplete,  ///< cut off by the recording's beginning or end
  kGap,         ///< samples of the angle are missing, or missing where a turning point may be
  kDuration,    ///< the duration is outside of the tolerance
};

/// A stretch of the recording that is not used as a cycle.
struct LeftOutCycle {
  double begin_s = 0;
  double end_s = 0;
  CycleFault fault = CycleFault::kIncomplete;
  std::string reason;  ///< a sentence
};

struct CycleFindings {
  std::vector<MovementCycle> cycles;   ///< complete ones, in the order of time
  std::vector<LeftOutCycle> left_out;  ///< in the order of time
  double median_duration_s = 0;        ///< of the complete cycles without gaps; 0 if there are none
  double period_s = 0;  ///< by autocorrelation (movement_period.h), a check; 0: nothing repeats
  double noise = 0;     ///< standard deviation of the angle's white noise [unit of the angle]
  /// Beginnings that are not the most extreme point of their cycle, because all begin at the same one of its
  /// several high (or low) points (cycle_alignment.h), and where that lies between reversals [0..1].
  std::size_t moved = 0;
  double phase = 0;
  /// Sentences: the period contradicts the cycles; the movement's other turning points are more regular.
  std::vector<std::string> doubts;
};

/// Errors: a setting outside of its range; the message states it.
[[nodiscard]] Status CheckCycleSettings(const CycleSettings& settings);

/// Every stretch from the first to the last sample that is a number is either in a cycle or in one that was
/// left out; nothing is dropped silently. A rest at a turning point is divided between both cycles, and makes
/// them longer. Where the recording begins or ends at a turning point its time is unknown: that cycle is
/// incomplete. A step of the clock of more than 1.5 times the median is a gap. A gap over a turning point
/// makes one stretch of both cycles.
///
/// Times of turning points: turning_points.h. O(N).
/// @param time [N >= 16, s, strictly increasing] @param angle [N, rad or any unit; NaN where samples are
/// missing]
/// @return Errors: sizes, time not increasing, settings, no 16 samples that are numbers, an angle that never
/// changes or by no more than noise (12 standard deviations). No cycle is no error: `left_out` says why.
Result<CycleFindings> FindCycles(const std::vector<double>& time, const std::vector<double>& angle,
                                 const CycleSettings& settings);

[[nodiscard]] std::size_t CountLeftOut(const CycleFindings& findings, CycleFault fault);

/// The cycles found and those left out with reasons, one sentence each.
[[nodiscard]] std::vector<std::string> DescribeCycles(const CycleFindings& findings);

}  // namespace sinew
