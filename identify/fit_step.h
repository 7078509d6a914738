// One of several fits that are done one after the other.
#pragma once

#include <string>
#include <vector>

namespace sinew {

struct FitStep {
  std::string name;
  std::vector<int> parameters;  ///< that are free in it, increasing; all others keep what they have
  std::vector<int> blocks;      ///< that are compared in it, increasing
};

}  // namespace sinew
