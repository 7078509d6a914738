#include "identify/uncertainty/verdict.h"

#include <cmath>

namespace sinew {

const char* ToString(Verdict verdict) {
  switch (verdict) {
    case Verdict::kIdentifiable:
      return "identifiable";
    case Verdict::kWeak:
      return "weak";
    case Verdict::kNotIdentifiable:
      return "not_identifiable";
    case Verdict::kAtBound:
      return "at_bound";
  }
  return "?";
}

}  // namespace sinew

namespace sinew::uncertainty {

bool IsWide(const Parameter& parameter, double value, const Interval& interval) {
  if (interval.upper_x - interval.lower_x > kWeakShare) return true;
  const bool keeps_sign = parameter.lower >= 0 || parameter.upper <= 0;
  return keeps_sign && 0.5 * (interval.upper - interval.lower) > kWeakRelative * std::abs(value);
}

Verdict Judge(const Parameter& parameter, const Evidence& evidence) {
  if (!evidence.determined) return Verdict::kNotIdentifiable;
  if (evidence.interval.lower_open && evidence.interval.upper_open) return Verdict::kNotIdentifiable;
  if (evidence.at_bound) return Verdict::kAtBound;
  return IsWide(parameter, evidence.value, evidence.interval) ? Verdict::kWeak : Verdict::kIdentifiable;
}

}  // namespace sinew::uncertainty
