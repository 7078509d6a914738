// Quantiles by passes over the values, against those of the sorted values.
#include "datasets/order_statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "datasets/robust.h"

namespace sinew {
namespace {

constexpr std::size_t kMany = 700000;  // more than are kept, and than are kept of one group

// By the definition.
double OfSorted(const std::vector<double>& values, double share) {
  const double place = share * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::size_t>(place);
  if (low + 1 == values.size()) return values[low];
  return values[low] + (place - static_cast<double>(low)) * (values[low + 1] - values[low]);
}

const std::vector<double>& Shares() {
  static const std::vector<double> kShares{0, 1e-6, 0.01, 0.25, 0.5, 0.500001, 0.99, 1};
  return kShares;
}

struct Distribution {
  std::string name;
  double (*value)(double normal);
};

class OrderStatisticsOf : public testing::TestWithParam<Distribution> {};

TEST_P(OrderStatisticsOf, EqualThoseOfSortedValuesToTheLastBit) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (const std::size_t count : {std::size_t{1}, std::size_t{2}, std::size_t{1000}, kMany}) {
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i) values.push_back(GetParam().value(normal(random)));
    std::vector<double> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    const auto found = QuantilesOf(Shares(), [&](auto add) {
      for (const double v : values) add(v);
    });
    for (std::size_t s = 0; s < Shares().size(); ++s) {
      EXPECT_EQ(found[s], OfSorted(sorted, Shares()[s])) << count << " values, share " << Shares()[s];
      EXPECT_EQ(Quantile(values, Shares()[s]), found[s]);
    }
    std::vector<double> distances;
    const double middle = OfSorted(sorted, 0.5);
    for (const double v : values) distances.push_back(std::abs(v - middle));
    std::sort(distances.begin(), distances.end());
    EXPECT_EQ(RobustDeviation(values), 1.4826 * OfSorted(distances, 0.5));
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, OrderStatisticsOf,
    testing::Values(Distribution{"Noise", [](double x) { return x; }},
                    Distribution{"OneValue", [](double) { return -2.5; }},
                    Distribution{"Rounded", [](double x) { return std::round(4 * x) / 4; }},
                    Distribution{"FarFromZero", [](double x) { return 1e6 + 1e-6 * x; }},
                    // Two of three share all but their last bits.
                    Distribution{"Mixed", [](double x) { return x > 0.4 ? std::exp(9 * x) : 1 + 1e-13 * x; }},
                    Distribution{"Tiny", [](double x) { return 1e-310 * x; }}),
    [](const auto& one) { return one.param.name; });

TEST(OrderStatistics, OneZeroAndInfinitiesHaveTheirPlaces) {
  const double inf = std::numeric_limits<double>::infinity();
  std::vector<double> values(100000, 0.0);
  for (std::size_t i = 0; i < values.size(); i += 2) values[i] = -0.0;
  values.insert(values.end(), {-inf, inf, inf});
  EXPECT_EQ(Median(values), 0);
  EXPECT_EQ(Quantile({-inf, -inf, 1, 2, 3}, 0.5), 1);
  EXPECT_EQ(Quantile(values, 1), inf);
  EXPECT_EQ(FiniteQuantiles(values, {0, 1}), (std::vector<double>{0, 0}));
}

TEST(OrderStatistics, OfNoValuesAreNotKnown) {
  const auto found = FiniteQuantiles({NAN, INFINITY}, {0.1, 0.5});
  ASSERT_EQ(found.size(), 2U);
  EXPECT_TRUE(std::isnan(found[0]) && std::isnan(found[1]));
  EXPECT_EQ(CountFinite({NAN, 1, INFINITY, 2}), 2U);
}

}  // namespace
}  // namespace sinew
