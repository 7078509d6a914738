#include "identify/observation/quantisation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/random.h"

namespace sinew {
namespace {

// A noisy sine of amplitude 1, 500 samples.
std::vector<double> Continuous(Random& random, double noise = 0.01) {
  std::vector<double> values;
  for (int i = 0; i < 500; ++i) values.push_back(std::sin(0.05 * i) + noise * random.Normal());
  return values;
}

std::vector<double> Rounded(std::vector<double> values, double step) {
  for (double& value : values) value = step * std::round(value / step);
  return values;
}

TEST(QuantisationStep, FindsTheStepOfRoundedValues) {
  Random random(1);
  for (const double step : {0.4, 0.1, 2 * M_PI / 4096, 1.0 / 32768, 1e-4}) {
    const auto found = QuantisationStep(Rounded(Continuous(random), step));
    ASSERT_TRUE(found) << step;
    EXPECT_NEAR(*found, step, 1e-9 * step);
  }
}

TEST(QuantisationStep, ContinuousValuesHaveNone) {
  Random random(2);
  for (int round = 0; round < 200; ++round) {
    EXPECT_FALSE(QuantisationStep(Continuous(random, 0.1 * round / 200))) << round;
  }
}

TEST(QuantisationStep, FewContinuousValuesHaveNone) {
  Random random(3);
  for (int round = 0; round < 1000; ++round) {
    std::vector<double> values;
    for (int i = 0; i < 20; ++i) values.push_back(random.Normal());
    EXPECT_FALSE(QuantisationStep(values)) << round;
  }
}

TEST(QuantisationStep, DoesNotDependOnOrderSignOrUnit) {
  Random random(4);
  auto values = Rounded(Continuous(random), 0.05);
  const auto step = QuantisationStep(values);
  ASSERT_TRUE(step);
  std::reverse(values.begin(), values.end());
  EXPECT_EQ(QuantisationStep(values), step);
  for (double& value : values) value *= -1000;
  EXPECT_NEAR(QuantisationStep(values).value_or(0), 50, 1e-9);
}

TEST(QuantisationStep, AFewOtherValuesAreAllowed) {
  Random random(5);
  auto values = Rounded(Continuous(random), 0.05);
  values[17] += 0.0213;
  values[200] = -3.3333;
  values[300] = 0.01777;
  EXPECT_NEAR(QuantisationStep(values).value_or(0), 0.05, 1e-9);
  for (std::size_t i = 0; i < 25; ++i) values[20 * i] += 0.0123;  // 5 %
  EXPECT_FALSE(QuantisationStep(values));
}

TEST(QuantisationStep, IsFoundFarFromZeroAndThroughPrintedDigits) {
  Random random(6);
  const double step = 2 * M_PI / 4096;
  auto values = Rounded(Continuous(random), step);
  for (double& value : values) value = std::round((value + 1000 * step) * 1e6) / 1e6;
  EXPECT_NEAR(QuantisationStep(values).value_or(0), step, 1e-6 * step);
}

TEST(QuantisationStep, AConstantAddedAfterRoundingIsRemovedByDifferences) {
  Random random(7);
  auto values = Rounded(Continuous(random), 0.05);
  for (double& value : values) value += 0.02 * M_SQRT1_2;
  EXPECT_FALSE(QuantisationStep(values));
  const double any = values[123];
  for (double& value : values) value -= any;
  EXPECT_NEAR(QuantisationStep(values).value_or(0), 0.05, 1e-9);
}

TEST(QuantisationStep, ASignalAtRestHasNone) {
  std::vector<double> values(1000, 0.0);  // a plate before the step, exactly zero
  Random random(8);
  for (int i = 0; i < 9; ++i) values.push_back(random.Uniform(10, 500));
  EXPECT_FALSE(QuantisationStep(values));
  EXPECT_FALSE(QuantisationStep(std::vector<double>(100, 3.7))) << "a constant";
  std::vector<double> switches(100, 0.0);
  for (std::size_t i = 50; i < 100; ++i) switches[i] = 5;
  EXPECT_FALSE(QuantisationStep(switches)) << "a switch";
  EXPECT_FALSE(QuantisationStep({})) << "nothing";
}

}  // namespace
}  // namespace sinew
