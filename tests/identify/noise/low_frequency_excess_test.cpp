// What is more below some frequency than noise brings, and what is not.
#include "identify/noise/low_frequency_excess.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/constants.h"
#include "base/random.h"

namespace sinew::noise {
namespace {

constexpr double kMost = 1.75;  // ratio above which the diagnosis calls no model adequate

Vector White(Random& random, int n) {
  return Vector::NullaryExpr(n, [&](Eigen::Index) { return random.Normal(); });
}

Vector Autoregressive(Random& random, int n, double rho) {
  Vector x = White(random, n);
  for (int i = 1; i < n; ++i) x[i] = rho * x[i - 1] + std::sqrt(1 - rho * rho) * x[i];
  return x;
}

// Three sines of some cycles in all, deviation 1.
Vector Structure(Random& random, int n, double cycles) {
  Vector x = Vector::Zero(n);
  for (int k = 1; k <= 3; ++k) {
    const double phase = random.Uniform(0, 2 * kPi);
    for (int i = 0; i < n; ++i)
      x[i] += std::sqrt(2.0 / 3) * std::sin(2 * kPi * cycles * k / 3 * i / n + phase);
  }
  return x;
}

TEST(LowFrequencyExcess, WhiteNoiseUnderASmoothErrorIsFound) {
  for (const int n : {100, 300, 2000, 5000}) {
    int found = 0;
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
      Random random(seed);
      const auto excess = FindLowFrequencyExcess({4 * Structure(random, n, 6) + White(random, n)});
      if (!excess) continue;
      EXPECT_GT(excess->noise, 0.7) << n << ", " << seed;
      EXPECT_LT(excess->ratio(), 6) << n << ", " << seed;
      found += excess->ratio() > kMost ? 1 : 0;
    }
    EXPECT_GE(found, n < 300 ? 10 : 45) << n;
  }
}

// The upper three quarters of 200 samples alone would bound the noise by far more than what there is.
TEST(LowFrequencyExcess, FewSamplesAreEnoughForAnErrorOfThreeTimesTheNoise) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Random random(seed);
    const auto excess = FindLowFrequencyExcess({3 * Structure(random, 200, 6) + White(random, 200)});
    found += excess && excess->ratio() > kMost ? 1 : 0;
  }
  EXPECT_GE(found, 40);
}

TEST(LowFrequencyExcess, NoiseIsNone) {
  for (const double rho : {0.0, 0.5, 0.8, 0.9, 0.98}) {
    for (const int n : {100, 1000}) {
      for (std::uint64_t seed = 1; seed <= 50; ++seed) {
        Random random(seed);
        std::vector<Vector> trials;
        for (int trial = 0; trial < 4; ++trial) trials.push_back(Autoregressive(random, n, rho));
        const auto excess = FindLowFrequencyExcess(trials);
        if (excess) {
          EXPECT_LT(excess->ratio(), kMost) << rho << ", " << n << ", " << seed;
        }
      }
    }
  }
}

// Half of the variance slow: noise of many instruments, and no excess.
TEST(LowFrequencyExcess, SlowNoiseOfTheSizeOfTheWhiteOneIsNone) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Random random(seed);
    std::vector<Vector> trials;
    for (int trial = 0; trial < 4; ++trial)
      trials.emplace_back(Autoregressive(random, 1000, 0.95) + White(random, 1000));
    const auto excess = FindLowFrequencyExcess(trials);
    if (excess) {
      EXPECT_LT(excess->ratio(), kMost) << seed;
    }
  }
}

// Filtered noise: its upper band says nothing of the lower one.
TEST(LowFrequencyExcess, FilteredNoiseIsNone) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Random random(seed);
    const Vector white = White(random, 1010);
    for (const int length : {3, 6}) {
      Vector mean = Vector::Zero(1000);
      for (int k = 0; k < length; ++k) mean += white.segment(k, 1000) / length;
      const auto excess = FindLowFrequencyExcess({mean});
      if (excess) {
        EXPECT_LT(excess->ratio(), kMost) << seed;
      }
    }
    Vector twice = white;  // first-order low-pass forwards and backwards
    for (int i = 1; i < twice.size(); ++i) twice[i] = 0.7 * twice[i - 1] + 0.3 * twice[i];
    for (Eigen::Index i = twice.size() - 1; i-- > 0;) twice[i] = 0.7 * twice[i + 1] + 0.3 * twice[i];
    const auto excess = FindLowFrequencyExcess({twice});
    if (excess) {
      EXPECT_LT(excess->ratio(), kMost) << seed;
    }
  }
}

TEST(LowFrequencyExcess, ShortOrConstantStretchesSayNothing) {
  Random random(1);
  EXPECT_FALSE(FindLowFrequencyExcess({}));
  EXPECT_FALSE(FindLowFrequencyExcess({White(random, kSamplesForSpectrum - 1)}));
  EXPECT_FALSE(FindLowFrequencyExcess({Vector::Zero(200)}));
  EXPECT_TRUE(FindLowFrequencyExcess({White(random, 5), White(random, 200)}));
}

}  // namespace
}  // namespace sinew::noise
