// The pressure under one spring against its equation, its bounds and its derivatives.
#include "problems/contact/load/pressure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/random.h"
#include "problems/contact/effects.h"

namespace sinew {
namespace {

TEST(ContactPressure, SolvesItsEquationAndItsDerivativesAreThoseOfDifferences) {
  constexpr double kEquation = 1e-12;  // the root to rounding
  constexpr double kTolerance = 1e-7;  // central differences with h = 1e-5 of the size
  Random random(1);
  double worst_equation = 0;
  double worst = 0;
  for (int round = 0; round < 2000; ++round) {
    ElasticFoundation bed;
    bed.stiffness = std::pow(10, random.Uniform(4, 9));
    bed.dissipation = random.Uniform(0, 100);
    // Nulls too: they have branches of their own.
    BedEffects effects{random.Index(4) == 0 ? 0 : random.Uniform(-0.5, 2),
                       random.Index(4) == 0 ? 0 : std::pow(10, random.Uniform(-12, -5)),
                       random.Index(2) == 0 ? 0 : std::pow(10, random.Uniform(0, 5))};
    double depth = std::pow(10, random.Uniform(-6, -1.5));
    double rate = random.Uniform(-0.5 / 100, 0.3);
    // Neither tension nor a floor that takes the whole depth: both have tests of their own.
    if (effects.damping > 0) {
      rate = std::abs(rate);
      if (effects.compliance * effects.damping * rate > 0.9 * depth) effects.compliance = 0;
    }
    const Pressure p = PressureAt(bed, effects, depth, rate, true);
    const double compression = depth - effects.compliance * p.value;
    ASSERT_GT(compression, 0);
    const double law = bed.stiffness * kReferenceDepth *
                           std::pow(compression / kReferenceDepth, 1 + effects.exponent) *
                           (1 + bed.dissipation * rate) +
                       effects.damping * rate;
    // The compression is a difference: where the floor gives way much, it loses digits.
    worst_equation = std::max(worst_equation, std::abs(law - p.value) / p.value * compression / depth);

    const auto check = [&](double& value, double derivative, double size) {
      const double h = 1e-5 * size;
      const double middle = value;
      value = middle + h;
      const double right = PressureAt(bed, effects, depth, rate, true).value;
      value = middle - h;
      const double left = PressureAt(bed, effects, depth, rate, true).value;
      value = middle;
      worst = std::max(worst, std::abs((right - left) / (2 * h) - derivative) * size /
                                  std::max(p.value, std::abs(derivative) * size));
    };
    check(depth, p.by_depth, depth);
    check(rate, p.by_rate, 0.01);
    check(bed.stiffness, p.by_stiffness, bed.stiffness);
    check(bed.dissipation, p.by_dissipation, 1);
    check(effects.exponent, p.by_exponent, 0.1);
    if (effects.compliance > 0) check(effects.compliance, p.by_compliance, effects.compliance);
    if (effects.damping > 0) check(effects.damping, p.by_damping, effects.damping);
  }
  std::printf("equation to %.1e, derivatives to %.1e\n", worst_equation, worst);
  EXPECT_LT(worst_equation, kEquation);
  EXPECT_LT(worst, kTolerance);
}

TEST(ContactPressure, NeverPullsAndNeverPressesInTheAir) {
  const ElasticFoundation bed{1e6, 20, 0, 0, 0};
  for (const BedEffects& effects : {BedEffects{}, BedEffects{0.5, 1e-6}, BedEffects{-0.4, 0}}) {
    for (const bool by_exponent : {false, true}) {
      EXPECT_EQ(PressureAt(bed, effects, 0, 0.1, by_exponent).value, 0);
      EXPECT_EQ(PressureAt(bed, effects, -1e-3, 0.1, by_exponent).by_depth, 0);
      EXPECT_EQ(PressureAt(bed, effects, 1e-3, -0.051, by_exponent).value, 0);
      EXPECT_GT(PressureAt(bed, effects, 1e-3, -0.049, by_exponent).value, 0);
    }
  }
}

TEST(ContactPressure, DashpotsBesideTheSpringsDoNotPullEither) {
  const ElasticFoundation bed{1e6, 0, 0, 0, 0};
  for (const double exponent : {0.0, 0.3}) {
    const BedEffects effects{exponent, 0, 1e4};
    const double still = PressureAt(bed, effects, 1e-3, 0, false).value;
    EXPECT_NEAR(still, 1e3, 1e-9) << "at the reference depth";
    EXPECT_GT(PressureAt(bed, effects, 1e-3, -0.099, false).value, 0);
    const Pressure lifted = PressureAt(bed, effects, 1e-3, -0.101, true);
    EXPECT_EQ(lifted.value, 0);
    EXPECT_EQ(lifted.by_depth, 0);
    EXPECT_EQ(lifted.by_damping, 0);
    EXPECT_EQ(PressureAt(bed, effects, -1e-3, 1, false).value, 0) << "in the air";
  }
}

TEST(ContactPressure, AFloorSofterThanTheDashpotsTakesTheWholeDepth) {
  constexpr double kRounding = 1e-12;
  const ElasticFoundation bed{1e6, 0, 0, 0, 0};
  const BedEffects effects{0, 1e-5, 1e4};
  const double rate = 0.1;  // 1 kPa of the dashpots press it by 10 mm
  const double depth = effects.compliance * effects.damping * rate;  // all of it
  const Pressure less = PressureAt(bed, effects, 0.5 * depth, rate, false);
  EXPECT_NEAR(less.value, 0.5 * depth / effects.compliance, kRounding * less.value);
  EXPECT_EQ(less.by_rate, 0);
  EXPECT_EQ(less.by_stiffness, 0);
  EXPECT_NEAR(PressureAt(bed, effects, depth * (1 + 1e-9), rate, false).value,
              PressureAt(bed, effects, depth, rate, false).value, 1e-5)
      << "a step where the springs begin";
}

TEST(ContactPressure, OfAStraightBedIsThatOfEveryBedToTheLastBit) {
  Random random(2);
  for (int round = 0; round < 1000; ++round) {
    ElasticFoundation bed;
    bed.stiffness = std::pow(10, random.Uniform(4, 9));
    bed.dissipation = random.Uniform(0, 100);
    const double depth = random.Uniform(-0.001, 0.01);
    const double rate = random.Uniform(-0.05, 0.3);
    const Pressure fast = PressureAt(bed, {}, depth, rate, false);
    const Pressure other = PressureOfBentBed(bed, {}, depth, rate, false);
    EXPECT_EQ(fast.value, other.value);
    EXPECT_EQ(fast.by_depth, other.by_depth);
    EXPECT_EQ(fast.by_rate, other.by_rate);
    EXPECT_EQ(fast.by_stiffness, other.by_stiffness);
    EXPECT_EQ(fast.by_dissipation, other.by_dissipation);
    EXPECT_EQ(fast.by_compliance, other.by_compliance);
    EXPECT_EQ(fast.by_damping, other.by_damping);
  }
}

}  // namespace
}  // namespace sinew
