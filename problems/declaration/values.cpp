#include "problems/declaration/values.h"

#include <algorithm>

namespace sinew {

double SampledInput::At(double t) const {
  if (t <= time.front()) return values.front();
  if (t >= time.back()) return values.back();
  const auto after = static_cast<std::size_t>(std::upper_bound(time.begin(), time.end(), t) - time.begin());
  const double share = (t - time[after - 1]) / (time[after] - time[after - 1]);
  return values[after - 1] + share * (values[after] - values[after - 1]);
}

}  // namespace sinew
