// What is wrong with measured data: facts. cli/data/check_text turns them into sentences.
#pragma once

#include <string>
#include <vector>

namespace sinew {

/// What was found; after the colon, what `size` and `usual` of the finding hold. "Its unit" is the channel's.
enum class FindingKind {
  kTimeJump,   ///< the clock of a grid jumps; no channel: largest step and usual step [s]
  kDropout,    ///< falls to one value and comes back: largest jump, usual large step [its unit]
  kSpike,      ///< single samples far from their neighbours: the same
  kDisplaced,  ///< jumps away and back (a swapped marker): the same
  kStuck,      ///< repeats one value exactly while it should move: that value, longest duration [s]
  kClipping,   ///< flat at its extreme value: that value, share of all samples
  kUnit,       ///< scale as of another unit: factor by which the numbers are too large, expected 1
  kSign,       ///< has the opposite sign: correlation with what is expected, and elsewhere
  kAxis,       ///< another axis: `other` is the channel that it agrees with
  kLag,        ///< out of step: delay [s, positive: late], usual delay [s]
  kDrift,      ///< the level at rest changes: change, scatter at rest [its unit]
  kOddCycle,   ///< single cycles unlike the others: largest and usual RMS deviation [its unit]
  kOddTrial,   ///< a short trial unlike the others: the same
  kTwoFeet,    ///< a plate that a second foot touches: longest contact, usual one [s]; `other` is the plate
  kInconsistent,  ///< contradicts channels of its own grid: largest deviation from 1 of the norm of a
                  ///< quaternion
  kNothingUsable  ///< no measured sample of any training trial is left; no trial, no channel
};

/// "time_jump", "dropout", ...: the `kind` in JSON.
[[nodiscard]] const char* ToString(FindingKind kind);

struct TimeSpan {
  double from = 0;  ///< [s]
  double to = 0;    ///< [s]
};

struct Finding {
  FindingKind kind = FindingKind::kDropout;
  std::string trial;
  std::string grid;
  std::string channel;
  std::string unit;
  std::vector<TimeSpan> spans;  ///< in order; the whole grid if the fault is the whole channel's
  bool whole = false;           ///< the fault is of the whole channel in this trial
  double size = 0;              ///< see FindingKind
  double usual = 0;             ///< see FindingKind
  int among = 0;                ///< how many cycles or trials were compared, this one included
  std::string other = {};       ///< what it was compared with: a channel, or a trial
  /// Neither this trial nor `other` can be told to be the wrong one: nothing is masked.
  bool undecided = false;
};

/// Sum of the lengths of the spans [s].
[[nodiscard]] double Duration(const std::vector<TimeSpan>& spans);

}  // namespace sinew
