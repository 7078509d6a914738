#include "identify/observation/delay_line.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "base/spline.h"

namespace sinew {
namespace {

TEST(DelayLine, IsTheNaturalCubicSpline) {
  constexpr int kSamples = 60;
  constexpr double kRounding = 1e-13;
  Random random(1);
  std::vector<double> time{-1};
  while (time.size() < kSamples) time.push_back(time.back() + random.Uniform(0.01, 0.1));
  const DelayLine line(time);
  for (const double delay : {0.0, 0.003, -0.02, 0.35, -0.4, 9.0, -9.0}) {
    Vector signal(kSamples);
    for (double& value : signal) value = random.Normal();
    const auto spline =
        NaturalCubicSpline::Fit(time, std::vector<double>(signal.data(), signal.data() + kSamples));
    ASSERT_TRUE(spline);
    Vector second(kSamples);
    Vector value(kSamples);
    Vector slope(kSamples);
    line.Fit(signal, second);
    line.Evaluate(delay, signal, second, value, slope);
    for (int i = 0; i < kSamples; ++i) {
      const auto expected = spline->At(time[static_cast<std::size_t>(i)] - delay);
      const double size = 1 + std::abs(expected.value) + std::abs(expected.first);
      EXPECT_NEAR(value[i], expected.value, kRounding * size) << i << " delayed by " << delay;
      EXPECT_NEAR(slope[i], expected.first, 1e3 * kRounding * size) << i << " delayed by " << delay;
    }
  }
}

TEST(DelayLine, TwoSamplesAreALineAndOneAConstant) {
  const DelayLine two({1, 3});
  const Vector signal = (Vector(2) << 5, 9).finished();
  Vector second(2);
  Vector value(2);
  Vector slope(2);
  two.Fit(signal, second);
  two.Evaluate(0.5, signal, second, value, slope);
  EXPECT_EQ(value, (Vector(2) << 4, 8).finished());
  EXPECT_EQ(slope, (Vector(2) << 2, 2).finished());

  const DelayLine one({1});
  one.Fit(signal.head(1), second.head(1));
  one.Evaluate(0.5, signal.head(1), second.head(1), value.head(1), slope.head(1));
  EXPECT_EQ(value[0], 5);
  EXPECT_EQ(slope[0], 0);
}

}  // namespace
}  // namespace sinew
