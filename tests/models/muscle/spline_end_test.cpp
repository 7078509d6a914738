#include "models/muscle/spline_end.h"

#include <gtest/gtest.h>

#include <cmath>

#include "models/muscle/spline_slopes.h"

namespace sinew {
namespace {

TEST(SplineEndWeights, GiveTheLastSlopeOfTheSpline) {
  std::vector<double> time;
  std::vector<double> values;
  for (int i = 0; i < 40; ++i) {
    time.push_back(0.01 * i + (i > 20 ? 0.003 * std::sin(i) : 0));
    values.push_back(std::sin(9 * time.back()));
  }
  const std::vector<double> weights = SplineEndWeights(time);
  ASSERT_EQ(weights.size(), time.size() * kSplinePoints);
  for (std::size_t i = 0; i < time.size(); ++i) {
    const std::size_t first = i + 1 > kSplinePoints ? i + 1 - kSplinePoints : 0;
    const auto at = [&](const std::vector<double>& of) {
      return std::vector<double>(of.begin() + static_cast<std::ptrdiff_t>(first),
                                 of.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    };
    double slope = 0;
    for (std::size_t k = 0; k < kSplinePoints; ++k) {
      const double weight = weights[i * kSplinePoints + k];
      if (i + k + 1 < kSplinePoints) {
        EXPECT_EQ(weight, 0) << i << ", " << k;
      } else {
        slope += weight * values[i + k + 1 - kSplinePoints];
      }
    }
    EXPECT_NEAR(slope, SplineSlopes(at(time), at(values)).back(), 1e-9) << i;
  }
}

}  // namespace
}  // namespace sinew
