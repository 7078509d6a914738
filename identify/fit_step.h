// One step of a stepwise identification: several fits in sequence.
#pragma once

#include <string>
#include <vector>

namespace sinew {

struct FitStep {
  std::string name;
  std::vector<int> parameters;  ///< free in this step, increasing; all others keep their values
  std::vector<int> blocks;      ///< in the cost of this step, increasing
};

}  // namespace sinew
