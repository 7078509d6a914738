// The middle of some values.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace sinew {

/// Of an even number the upper one of the middle two. O(N). @param values not empty, no NaN
[[nodiscard]] inline double UpperMedian(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace sinew
