// All combinations of the probe values of an effect's parameters.
#pragma once

#include <utility>
#include <vector>

#include "identify/parameter.h"

namespace sinew {

/// Values of some parameters: index, value.
using ProbeValues = std::vector<std::pair<int, double>>;

/// One entry for each combination of the probe values of those parameters of a group that have any
/// (Parameter::probes), the last parameter's values changing fastest; a single empty entry if none has.
/// @param parameters of the problem, or of a fit @param group indices into it
[[nodiscard]] std::vector<ProbeValues> ProbeGrid(const std::vector<Parameter>& parameters,
                                                 const std::vector<int>& group);

}  // namespace sinew
