#include "models/muscle/spline_end.h"

#include <algorithm>

#include "models/muscle/spline_slopes.h"

namespace sinew {

std::vector<double> SplineEndWeights(const std::vector<double>& time) {
  std::vector<double> weights(time.size() * kSplinePoints, 0);
  std::vector<double> intervals;
  std::vector<double> last_intervals;
  for (std::size_t i = 0; i < time.size(); ++i) {
    const std::size_t first = i + 1 > kSplinePoints ? i + 1 - kSplinePoints : 0;
    const std::vector<double> times(time.begin() + static_cast<std::ptrdiff_t>(first),
                                    time.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    double* row = &weights[i * kSplinePoints + kSplinePoints - times.size()];
    intervals.clear();
    for (std::size_t k = 1; k < times.size(); ++k) intervals.push_back(times[k] - times[k - 1]);
    if (intervals == last_intervals && times.size() == kSplinePoints) {
      std::copy(row - kSplinePoints, row, row);
      continue;
    }
    for (std::size_t k = 0; k < times.size(); ++k) {
      std::vector<double> unit(times.size(), 0);
      unit[k] = 1;
      row[k] = SplineSlopes(times, unit).back();
    }
    std::swap(intervals, last_intervals);
  }
  return weights;
}

}  // namespace sinew
