// What may be wrong with the model of a thrown body, and its parameters with their ranges.
#pragma once

#include "problems/free_body/free_body.h"
#include "problems/kit/parameter_list.h"

namespace sinew {

/// By FreeBodySlot.
/// @param speed highest of the tosses [m/s]: an impact at it, a tenth of the body's size deep, is where
/// the stiffness starts
[[nodiscard]] ParameterList ListFreeBodyParameters(const FreeBody& body, double speed);

}  // namespace sinew
