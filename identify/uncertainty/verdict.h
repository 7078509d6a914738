// When a parameter counts as identified: every rule and every threshold in one place.
#pragma once

#include "identify/parameter.h"

namespace sinew {

/// How well the data determine one parameter; the rules, in the order in which they are tried:
///  - not identifiable: no fitted channel depends on it; or only a combination with other values is
///    determined (rank loss); or its 95 % interval reaches both bounds, so that the data add nothing to them.
///  - at bound: the best value lies on a bound and the cost still falls beyond it.
///  - weak: its 95 % interval takes more than kWeakShare of its range, or, for a parameter that cannot change
///    its sign, is wider than +-kWeakRelative of its value.
///  - identifiable: all others.
enum class Verdict { kIdentifiable, kWeak, kNotIdentifiable, kAtBound };

/// "identifiable", "weak", "not_identifiable", "at_bound".
[[nodiscard]] const char* ToString(Verdict verdict);

/// A 95 % interval in the unit box and in natural units.
struct Interval {
  double lower_x = 0;
  double upper_x = 1;
  double lower = 0;
  double upper = 0;
  bool lower_open = true;  ///< it reaches the lower bound, where it is cut off
  bool upper_open = true;
};

}  // namespace sinew

namespace sinew::uncertainty {

/// Half-width of the 95 % interval, over the value. Beyond a half, the value is of little use.
/// For a signed quantity near zero (an offset) this is meaningless; there only the share of the range counts.
inline constexpr double kWeakRelative = 0.5;
/// Width of the 95 % interval over that of the range (of logarithms for Scale::kLog).
inline constexpr double kWeakShare = 0.5;
/// On a bound, in the unit box: above what a converged solver leaves, far below any relevant difference.
inline constexpr double kBoundTolerance = 1e-6;
/// A block does not depend on a variable if the slope over its whole range is below this share of the block's
/// values: about sqrt(eps), which is the noise of derivatives by differences.
inline constexpr double kNoChange = 1e-8;
/// Singular values of the Jacobian with columns of unit length, over the largest: below, the rank is lost to
/// rounding whatever the noise.
inline constexpr double kRankTolerance = 1e-7;
/// Loading from which a parameter takes part in a direction that is lost.
inline constexpr double kTakesPart = 1e-3;

/// What is known of one parameter when it is judged.
struct Evidence {
  bool determined = true;  ///< false: no dependence, or rank loss
  bool at_bound = false;
  double value = 0;
  Interval interval;
};

[[nodiscard]] Verdict Judge(const Parameter& parameter, const Evidence& evidence);

/// True if the interval is too wide for a clear "identifiable" (the rule of weak).
[[nodiscard]] bool IsWide(const Parameter& parameter, double value, const Interval& interval);

}  // namespace sinew::uncertainty
