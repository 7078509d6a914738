// Two names for one effect: a diagnosis could never tell them apart.
#pragma once

#include "base/error.h"
#include "identify/problem.h"

namespace sinew {

/// Whether any two effects are one: with as many parameters, of which each changes every prediction of every
/// block by the same factor times what its counterpart of the other effect does (to 1e-6), at all of several
/// points with all effects present. Effects that change nothing are not compared, nor is anything where fewer
/// than two points can be predicted. Costs three evaluations with derivatives.
/// @return the error names both effects, and what both do
[[nodiscard]] Status CheckDistinctEffects(const Problem& problem);

}  // namespace sinew
