// What `sinew data synthesize` hides with --effect, for problems that describe their effects themselves.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "identify/effect.h"
#include "identify/parameter.h"
#include "problems/registry.h"

namespace sinew {

/// Values by parameter. @param outsiders names of what the laboratory can do and no effect describes; each
/// has one number, of its own name. Errors: an effect or a parameter that does not exist (with a suggestion),
/// a value out of its range.
Result<std::map<std::string, double>> ReadHiddenEffects(const SynthesisRequest& request,
                                                        const std::vector<Effect>& effects,
                                                        const std::vector<Parameter>& parameters,
                                                        const std::vector<std::string>& outsiders = {});

}  // namespace sinew
