// What may be wrong with the model of a thrown body, and its parameters with their ranges.
#pragma once

#include <array>
#include <vector>

#include "identify/effect.h"
#include "identify/parameter.h"
#include "problems/free_body/free_body.h"

namespace sinew {

struct FreeBodyParameterList {
  std::vector<Parameter> parameters;
  std::vector<Effect> effects;
  std::vector<DiscrepancyPort> ports;
  std::array<int, kFreeBodySlots> index{};  ///< of the parameter of a slot, or -1
};

/// @param speed highest of the tosses [m/s]: an impact at it, a tenth of the body's size deep, is where
/// the stiffness starts
[[nodiscard]] FreeBodyParameterList ListFreeBodyParameters(const FreeBody& body, double speed);

}  // namespace sinew
