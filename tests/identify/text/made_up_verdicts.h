// Facts about parameters as an identification might return them; nothing in them was computed.
#pragma once

#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "identify/identification/identification.h"
#include "tests/identify/support/toy_problem.h"

namespace sinew::toy {

/// Parameters a [N/m], b, c, d and e within 0..100, and nothing known of them yet.
inline Identification FiveParameters() {
  Identification identification;
  for (const char* name : {"a", "b", "c", "d", "e"})
    identification.setup.parameters.push_back(MakeParameter(name, 0, 100, 1));
  identification.setup.parameters[0].unit = "N/m";
  return identification;
}

/// 12.345, with a 95 % interval from 12 to 12.7.
inline ParameterVerdict Judged(int parameter, Verdict verdict, Reason reason, Remedy remedy = {}) {
  ParameterVerdict v;
  v.parameter = parameter;
  v.verdict = verdict;
  v.value = 12.345;
  v.ci95_lower = 12;
  v.ci95_upper = 12.7;
  v.reason = std::move(reason);
  v.remedy = std::move(remedy);
  return v;
}

/// Half an interval of 3 % of the value.
inline Reason ReasonOf(ReasonKind kind, std::vector<std::string> partners = {}) {
  Reason reason;
  reason.kind = kind;
  reason.partners = std::move(partners);
  reason.channels = {"force_y"};
  reason.width = 0.03;
  reason.width_of_value = true;
  reason.std_error = 2.5;
  reason.std_error_without = 0.125;
  reason.nuisance = 1;
  return reason;
}

inline RemedyOption Option(AdditionKind kind, std::string name, double std_error) {
  return {{{kind, std::move(name)}}, std_error};
}

}  // namespace sinew::toy
