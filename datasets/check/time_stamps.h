// Clocks that jump.
#pragma once

#include <vector>

#include "datasets/check/finding.h"
#include "datasets/dataset.h"

namespace sinew {

/// Steps of a grid's time unlike its others: above 1.5 or below 0.5 of the median step where the clock is
/// regular, above three times the 99th percentile where it is not. A grid whose rate differs tenfold from
/// that of the same grid in other trials has its times in another unit.
[[nodiscard]] std::vector<Finding> FindTimeJumps(const Dataset& dataset);

}  // namespace sinew
