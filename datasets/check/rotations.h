// Quaternions that are no rotations.
#pragma once

#include <vector>

#include "datasets/check/finding.h"
#include "datasets/dataset.h"

namespace sinew {

/// Channels NAME_w, NAME_x, NAME_y, NAME_z of unit 1 whose norm differs from 1 by more than 0.02: a finding
/// about NAME_w, with the spans in which it does, that names the others. Three of four of the norms of a
/// trial, or all of another trial, must be 1.
[[nodiscard]] std::vector<Finding> FindBrokenRotations(const Dataset& dataset);

}  // namespace sinew
