#include "problems/kit/hidden_effects.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/numbers.h"
#include "base/text.h"

namespace sinew {
namespace {

using ParametersOfEffect = std::vector<const Parameter*>;

std::vector<std::string> NamesOf(const ParametersOfEffect& parameters) {
  std::vector<std::string> names;
  for (const Parameter* p : parameters) names.push_back(p->name);
  return names;
}

// The parameters of an effect of either list.
Result<ParametersOfEffect> ParametersOf(const std::string& name, const ParameterList& effects,
                                        const ParameterList& outsiders) {
  std::vector<std::string> known;
  for (const ParameterList* list : {&effects, &outsiders}) {
    for (const Effect& effect : list->effects) {
      known.push_back(effect.name);
      if (effect.name != name) continue;
      ParametersOfEffect own;
      for (const int index : effect.parameters)
        own.push_back(&list->parameters[static_cast<std::size_t>(index)]);
      return own;
    }
  }
  return Fail("--effect: '{}' does not exist{}", name, Suggestion(name, known));
}

// One PARAM=VALUE.
Result<std::pair<std::string, double>> ReadNumber(const std::string& effect, const ParametersOfEffect& own,
                                                  const std::string& name, double value) {
  const auto found = std::find_if(own.begin(), own.end(), [&](const Parameter* p) {
    return p->name == name || (name == "value" && own.size() == 1);
  });
  if (found == own.end())
    return Fail("--effect {}: '{}' does not exist{}", effect, name, Suggestion(name, NamesOf(own)));
  const Parameter& p = **found;
  if (!(value >= p.lower && value <= p.upper)) {
    return Fail("--effect {}:{}={}: expected {} to {} {}", effect, name, value, Readable(p.lower),
                Readable(p.upper), p.unit);
  }
  return std::pair{p.name, value};
}

}  // namespace

ParameterList EffectsOf(const Problem& problem) {
  return {problem.parameters(), problem.effects(), problem.ports(), {}};
}

Result<std::map<std::string, double>> ReadHiddenEffects(const RequestedEffects& requested,
                                                        const ParameterList& effects,
                                                        const ParameterList& outsiders) {
  std::map<std::string, double> hidden;
  for (const auto& [effect, numbers] : requested) {
    SINEW_ASSIGN(const ParametersOfEffect own, ParametersOf(effect, effects, outsiders));
    if (numbers.empty()) {
      return Fail("--effect {}: expected {}:{}=NUMBER", effect, effect, fmt::join(NamesOf(own), "=NUMBER,"));
    }
    for (const auto& [name, value] : numbers) {
      SINEW_ASSIGN(const auto number, ReadNumber(effect, own, name, value));
      if (!hidden.insert(number).second)
        return Fail("--effect {}: '{}' is given twice", effect, number.first);
    }
  }
  return hidden;
}

}  // namespace sinew
