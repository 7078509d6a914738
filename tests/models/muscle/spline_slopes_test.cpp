#include "models/muscle/spline_slopes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/dual.h"

namespace sinew {
namespace {

// A spline without knots next to the ends reproduces any cubic.
TEST(SplineSlopesTest, ExactForCubicsOnUnevenSamples) {
  for (const std::size_t n : {4U, 5U, 12U}) {
    std::vector<double> time;
    std::vector<double> values;
    for (std::size_t i = 0; i < n; ++i) {
      const double t = 0.1 * static_cast<double>(i) + 0.03 * std::sin(static_cast<double>(7 * i));
      time.push_back(t);
      values.push_back(1 - 2 * t + 3 * t * t - 4 * t * t * t);
    }
    const auto slopes = SplineSlopes(time, values);
    for (std::size_t i = 0; i < n; ++i)
      EXPECT_NEAR(slopes[i], -2 + 6 * time[i] - 12 * time[i] * time[i], 1e-11) << n << " " << i;
  }
}

TEST(SplineSlopesTest, FewSamples) {
  EXPECT_EQ(SplineSlopes<double>({1}, {5}), std::vector<double>{0});
  const auto line = SplineSlopes<double>({1, 3}, {5, 9});
  EXPECT_EQ(line[0], 2);
  EXPECT_EQ(line[1], 2);
  const auto parabola = SplineSlopes<double>({0, 1, 3}, {0, 1, 9});
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(parabola[i], std::vector<double>({0, 2, 6})[i], 1e-14);
}

TEST(SplineSlopesTest, LinearInTheSamples) {
  const std::vector<double> time{0, 0.1, 0.25, 0.3, 0.5};
  std::vector<Dual<1>> values;
  for (const double t : time) {
    Dual<1> x(std::sin(5 * t));
    x.d[0] = t * t;
    values.push_back(x);
  }
  const auto slopes = SplineSlopes(time, values);
  for (std::size_t i = 0; i < time.size(); ++i) EXPECT_NEAR(slopes[i].d[0], 2 * time[i], 1e-12) << i;
}

}  // namespace
}  // namespace sinew
