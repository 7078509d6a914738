// Correlations at many lags, against one at a time.
#include "datasets/lagged_correlation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "datasets/robust.h"

namespace sinew {
namespace {

std::vector<double> Delayed(const std::vector<double>& x, int lag) {
  std::vector<double> delayed(x.size(), NAN);
  for (int i = 0; i < static_cast<int>(x.size()); ++i) {
    if (i - lag >= 0 && i - lag < static_cast<int>(x.size()))
      delayed[static_cast<std::size_t>(i)] = x[static_cast<std::size_t>(i - lag)];
  }
  return delayed;
}

// Far from 0, longer than a block, with a delay of 7 between them.
struct Pair {
  std::vector<double> a, b;

  explicit Pair(std::size_t samples) {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    double level = 0;
    for (std::size_t i = 0; i < samples; ++i) {
      level = 0.95 * level + normal(random);
      a.push_back(1000 + level);
    }
    b = Delayed(a, 7);
    for (double& v : b) v = 3 * v + 0.1 * normal(random);
  }
};

void ExpectThoseOfOneLagAtATime(const Pair& pair, int longest) {
  const auto found = LaggedCorrelations(pair.a, pair.b, longest);
  ASSERT_EQ(found.size(), static_cast<std::size_t>(2 * longest + 1));
  for (int lag = -longest; lag <= longest; ++lag) {
    // Sums of squares of differences from means: rounding alone is between them.
    EXPECT_NEAR(found[static_cast<std::size_t>(lag + longest)], Correlation(Delayed(pair.a, lag), pair.b),
                1e-12)
        << lag;
  }
  EXPECT_GT(found[static_cast<std::size_t>(7 + longest)], 0.999);
}

TEST(LaggedCorrelation, EqualsThatOfDelayedSeries) {
  ExpectThoseOfOneLagAtATime(Pair(10000), 20);
  ExpectThoseOfOneLagAtATime(Pair(50), 12);
}

TEST(LaggedCorrelation, LeavesPairsWithGapsOut) {
  Pair pair(10000);
  for (std::size_t i = 3000; i < 3100; ++i) pair.a[i] = NAN;
  for (std::size_t i = 5; i < 10000; i += 17) pair.b[i] = NAN;
  ExpectThoseOfOneLagAtATime(pair, 30);
}

TEST(LaggedCorrelation, IsNotKnownOfWhatDoesNotVary) {
  for (const double r : LaggedCorrelations(std::vector<double>(100, 1e6), Pair(100).b, 3))
    EXPECT_TRUE(std::isnan(r));
}

}  // namespace
}  // namespace sinew
