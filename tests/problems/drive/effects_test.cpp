#include "problems/drive/effects.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <vector>

#include "base/constants.h"

namespace sinew {
namespace {

// Of a ripple, tried by the diagnosis: cycles per position, increasing.
std::vector<double> RipplesTried(bool rotary, double range, double readings) {
  DriveTraits traits;
  traits.rotary = rotary;
  DriveScales scales;
  scales.position = range;
  scales.samples = readings;
  DriveStarts starts;
  starts.fill(1);
  const auto list = ListDriveParameters(traits, scales, starts);
  const auto period = std::find_if(list.parameters.begin(), list.parameters.end(),
                                   [](const Parameter& p) { return p.name == "cogging_period"; });
  if (period == list.parameters.end()) return {};
  std::vector<double> tried;
  for (const double one : period->probes) {
    EXPECT_GE(one, period->lower);
    EXPECT_LE(one, period->upper);
    tried.push_back(1 / one);
  }
  std::sort(tried.begin(), tried.end());
  return tried;
}

double WidestGap(const std::vector<double>& increasing) {
  double widest = 0;
  for (std::size_t i = 1; i < increasing.size(); ++i)
    widest = std::max(widest, increasing[i] - increasing[i - 1]);
  return widest;
}

TEST(DriveEffects, RipplesOverManyTurnsAreTriedACycleApart) {
  const double range = 40;
  const auto tried = RipplesTried(true, range, 4800);
  ASSERT_GT(tried.size(), 100U);
  EXPECT_NEAR(tried.front(), 2 / (2 * kPi), 1e-12);
  EXPECT_LE(WidestGap(tried) * range, 1 + 1e-9);
  EXPECT_GE((tried.back() + 1 / range) * 2 * kPi, 30 - 1e-9) << "down to a thirtieth of a turn";
}

TEST(DriveEffects, RipplesAlongAnAxisAreTriedACycleApart) {
  const double range = 0.8;
  const auto tried = RipplesTried(false, range, 4800);
  EXPECT_LE(WidestGap(tried) * range, 1 + 1e-9);
  EXPECT_LT(tried.size(), 40U);
}

TEST(DriveEffects, FewRipplesAreTriedWithinATurnAndWithManyReadings) {
  EXPECT_EQ(RipplesTried(true, 2, 4800).size(), 6U);
  EXPECT_LT(RipplesTried(true, 1000, 1e7).size(), 40U) << "each has columns of all readings";
}

}  // namespace
}  // namespace sinew
