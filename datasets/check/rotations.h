// Quaternions that are no rotations.
#pragma once

#include <vector>

#include "datasets/check/finding.h"
#include "datasets/dataset.h"

namespace sinew {

/// Channels NAME_w, NAME_x, NAME_y, NAME_z of unit 1 whose norm differs from 1 by more than 0.02: a finding
/// about NAME_w, with the spans in which it does, that names the others. Where no trial has a
/// norm of 1 throughout, three quarters of the samples must have it: else the four are no quaternion.
[[nodiscard]] std::vector<Finding> FindBrokenRotations(const Dataset& dataset);

}  // namespace sinew
