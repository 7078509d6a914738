// Sets of causes are fitted again from further starts, because local searches end in local minima.
#pragma once

#include <cstdint>
#include <vector>

#include "identify/diagnosis/select/set_fitter.h"

namespace sinew::diagnosis {

/// From the values that the other sets, and the judged sets with one cause less, have found for the
/// parameters they share; those that fit best also from random points around their own solution. A set that
/// fits no better stays as it is. @param sets fitted, by fitted error; errors of left-out data become unknown
/// where it fits better
void FitFromEachOther(const SetFitter& fitter, const std::vector<FittedSet>& judged, std::uint64_t seed,
                      std::vector<FittedSet>& sets);

/// The set after rounds of random starts around the best solution so far (basin hopping: Wales, Doye 1997, J.
/// Phys. Chem. A 101:5111-5116), so that it does not depend on where the search came from; unchanged if
/// left-out data are predicted no better. @pre its error of left-out data is known
[[nodiscard]] FittedSet FitAround(const SetFitter& fitter, std::uint64_t seed, const FittedSet& one);

}  // namespace sinew::diagnosis
