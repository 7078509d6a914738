#include "datasets/check/finding.h"

namespace sinew {

const char* ToString(FindingKind kind) {
  switch (kind) {
    case FindingKind::kTimeJump:
      return "time_jump";
    case FindingKind::kDropout:
      return "dropout";
    case FindingKind::kSpike:
      return "spike";
    case FindingKind::kDisplaced:
      return "displaced";
    case FindingKind::kStuck:
      return "stuck";
    case FindingKind::kClipping:
      return "clipping";
    case FindingKind::kUnit:
      return "unit";
    case FindingKind::kSign:
      return "sign";
    case FindingKind::kAxis:
      return "axis";
    case FindingKind::kLag:
      return "lag";
    case FindingKind::kDrift:
      return "drift";
    case FindingKind::kOddCycle:
      return "odd_cycle";
    case FindingKind::kOddTrial:
      return "odd_trial";
    case FindingKind::kTwoFeet:
      return "two_feet";
    case FindingKind::kInconsistent:
      return "inconsistent";
    case FindingKind::kNothingUsable:
      return "nothing_usable";
  }
  return "";
}

double Duration(const std::vector<TimeSpan>& spans) {
  double duration = 0;
  for (const TimeSpan& span : spans) duration += span.to - span.from;
  return duration;
}

}  // namespace sinew
