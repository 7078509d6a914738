#include "problems/kit/hidden_effects.h"

#include <algorithm>

#include "base/text.h"

namespace sinew {

Result<std::map<std::string, double>> ReadHiddenEffects(const SynthesisRequest& request,
                                                        const std::vector<Effect>& effects,
                                                        const std::vector<Parameter>& parameters,
                                                        const std::vector<std::string>& outsiders) {
  std::map<std::string, double> hidden;
  for (const auto& [name, numbers] : request.effects) {
    std::vector<std::string> known;
    const bool outsider = std::find(outsiders.begin(), outsiders.end(), name) != outsiders.end();
    if (outsider) {
      known.push_back(name);
    } else {
      const auto effect = std::find_if(effects.begin(), effects.end(),
                                       [&, wanted = name](const Effect& e) { return e.name == wanted; });
      if (effect == effects.end()) {
        std::vector<std::string> names = outsiders;
        for (const Effect& e : effects) names.push_back(e.name);
        return Fail("--effect: '{}' does not exist{}", name, Suggestion(name, names));
      }
      for (const int index : effect->parameters)
        known.push_back(parameters[static_cast<std::size_t>(index)].name);
    }
    for (const auto& [parameter, value] : numbers) {
      if (std::find(known.begin(), known.end(), parameter) == known.end())
        return Fail("--effect {}: '{}' does not exist{}", name, parameter, Suggestion(parameter, known));
      if (!outsider) {
        SINEW_ASSIGN(const int index, FindParameter(parameters, parameter));
        const Parameter& p = parameters[static_cast<std::size_t>(index)];
        if (!(value >= p.lower && value <= p.upper))
          return Fail("--effect {}: {} = {}, expected {} to {}", name, parameter, value, p.lower, p.upper);
      }
      hidden[parameter] = value;
    }
  }
  return hidden;
}

}  // namespace sinew
