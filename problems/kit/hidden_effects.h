// The one reader of `sinew data synthesize --effect`.
#pragma once

#include <map>
#include <string>

#include "base/error.h"
#include "identify/problem.h"
#include "problems/kit/parameter_list.h"
#include "problems/synthesis_request.h"

namespace sinew {

/// Checks what is asked for against what can be hidden: the effects of a problem, and of its laboratory what
/// no effect of the problem is.
/// An effect of one parameter also takes `value`. Parameters that are not given stay at their nulls.
/// @return values by parameter
/// Errors: no such effect or parameter (with a suggestion); no number (with the parameters that are
/// expected); a parameter that is given twice; a value out of its range.
Result<std::map<std::string, double>> ReadHiddenEffects(const RequestedEffects& requested,
                                                        const ParameterList& effects,
                                                        const ParameterList& outsiders = {});

/// What a problem offers, as it may be hidden.
[[nodiscard]] ParameterList EffectsOf(const Problem& problem);

/// An effect of the laboratory alone, which is one number of the same name.
struct Outsider {
  const char* name;
  const char* unit;
  const char* meaning;
};

/// @param outsiders any range of theirs, in both directions, null 0.
template <class Outsiders>
[[nodiscard]] ParameterList ListOutsiders(const Outsiders& outsiders) {
  constexpr double kReach = 1e9;
  ParameterList list;
  ParameterListBuilder add(list);
  for (const Outsider& outsider : outsiders) {
    add.BeginEffect(outsider.name, Level::kSensor, outsider.meaning, "");
    add.AddNumber(outsider.name, outsider.unit, outsider.meaning, -kReach, kReach);
  }
  return list;
}

}  // namespace sinew
