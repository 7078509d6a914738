// Plates that two feet stand on at once.
#pragma once

#include <vector>

#include "datasets/check/finding.h"
#include "datasets/dataset.h"

namespace sinew {

/// Contacts of a plate whose centre of pressure jumps by more than a foot, and those that last longer than
/// the others by as much as the other foot's plate is loaded longer at the same time (FindContacts): one
/// finding per plate and trial, about its vertical force.
[[nodiscard]] std::vector<Finding> FindTwoFeet(const Dataset& dataset);

}  // namespace sinew
