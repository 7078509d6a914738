#include "models/muscle/hill_muscle.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/models/muscle/soleus.h"

namespace sinew {
namespace {

// A fibre at its optimal length has the stated pennation.
TEST(HillMuscleTest, PennationIsThatOfConstantThickness) {
  const auto muscle = Soleus();
  const double sine = std::sin(0.436);
  EXPECT_NEAR(PennationCosine(muscle, sine, 0.05), std::cos(0.436), 1e-15);
  const double length = 0.07;
  EXPECT_NEAR(std::sin(std::acos(PennationCosine(muscle, sine, length))) * length, 0.05 * sine, 1e-15);
  EXPECT_NEAR(PennationCosine(muscle, sine, 0.001), std::sqrt(1 - 0.99 * 0.99), 1e-15);
}

TEST(HillMuscleTest, RigidFibreClosesTheTriangle) {
  const auto muscle = Soleus();
  const double length = RigidFibreLength(muscle, 0.3);
  EXPECT_NEAR(length * PennationCosine(muscle, std::sin(0.436), length), 0.3 - 0.25, 1e-15);
  auto parallel = muscle;
  parallel.pennation = 0;
  EXPECT_EQ(RigidFibreLength(parallel, 0.25), 0.05 * kShortestFibre) << "a tendon as long as the unit";
}

TEST(HillMuscleTest, ForceIsTheSumOfItsParts) {
  auto muscle = Soleus();
  muscle.strength = 1.2;
  const double l = 0.9 * 0.05;
  const double v = -0.1;
  const double a = 0.4;
  const double expected =
      3549 * 1.2 *
      (Curves().active_force_length(0.9 / (1 + 0.15 * 0.6)) * Curves().force_velocity(-0.1 / 0.5) * a +
       Curves().passive_force_length(0.9) + 0.1 * -0.1 / 0.5);
  EXPECT_NEAR(FibreForce(Curves(), muscle, l, v, a), expected, 1e-10);
}

TEST(HillMuscleTest, TendonForceIsZeroWhenSlack) {
  const auto muscle = Soleus();
  const double cosine = 0.9;
  EXPECT_NEAR(TendonForce(Curves(), muscle, 0.28, 0.05, cosine), 0, 1e-9);
  EXPECT_GT(TendonForce(Curves(), muscle, 0.30, 0.05, cosine), 1);
}

// Every parameter, activation and velocity.
TEST(HillMuscleTest, DerivativesAreThoseOfDifferences) {
  constexpr int kLanes = 10;
  const auto force = [](const std::array<double, kLanes>& p) {
    const HillMuscle<double> muscle{p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7]};
    const double length = RigidFibreLength(muscle, 0.3);
    return FibreForce(Curves(), muscle, length, p[8], p[9]) * PennationCosine(muscle, std::sin(p[4]), length);
  };
  const std::array<double, kLanes> at{0.05, 0.25, 3549, 1.1, 0.436, 0.15, 0.1, 10, -0.05, 0.6};
  std::array<Dual<kLanes>, kLanes> p;
  for (int i = 0; i < kLanes; ++i) p[i] = Dual<kLanes>::Variable(at[static_cast<std::size_t>(i)], i);
  const HillMuscle<Dual<kLanes>> muscle{p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7]};
  const auto length = RigidFibreLength(muscle, 0.3);
  const auto exact =
      FibreForce(Curves(), muscle, length, p[8], p[9]) * PennationCosine(muscle, Sin(p[4]), length);
  EXPECT_EQ(exact.value, force(at));
  for (std::size_t i = 0; i < at.size(); ++i) {
    auto up = at;
    auto down = at;
    const double step = 1e-6 * std::abs(at[i]);
    up[i] += step;
    down[i] -= step;
    const double slope = (force(up) - force(down)) / (2 * step);
    EXPECT_NEAR(exact.d[i], slope, 1e-6 * std::max(std::abs(slope), 1.0)) << i;
  }
}

// Short, long, slack and fast fibres, one that stands nearly across the tendon, and one without pennation.
TEST(HillMuscleTest, PartialDerivativesOfThePullAreThoseOfDualNumbers) {
  constexpr int kLanes = 11;
  using T = Dual<kLanes>;
  for (const double length : {0.012, 0.03, 0.055, 0.08}) {
    for (const double velocity : {-0.3, -0.01, 0.0, 0.2}) {
      for (const double pennation : {0.0, 0.436, 1.2}) {
        const std::array<double, kLanes> at{0.05, pennation, 3549,   1.1,      0.15, 0.1,
                                            10,   1.2,       length, velocity, 0.6};
        std::array<T, kLanes> p;
        for (int i = 0; i < kLanes; ++i) p[i] = T::Variable(at[static_cast<std::size_t>(i)], i);
        HillMuscle<T> muscle{p[0], T(0.25), p[2], p[3], p[1], p[4], p[5], p[6]};
        muscle.active_gain = p[7];
        const T sine = Sin(p[1]);
        const T exact = FibreForce(Curves(), muscle, p[8], p[9], p[10]) * PennationCosine(muscle, sine, p[8]);
        const Pull by = PullAt(Curves(), Plain(muscle), sine.value, length, velocity, 0.6);
        EXPECT_EQ(by.value, exact.value);
        const T thickness = p[0] * sine;
        const T strength = p[2] * p[3];
        for (std::size_t i = 0; i < kLanes; ++i) {
          const double slope = by.length * p[8].d[i] + by.velocity * p[9].d[i] + by.activation * p[10].d[i] +
                               ByMuscle(by, muscle, thickness, strength, i);
          EXPECT_NEAR(slope, exact.d[i], 1e-12 * std::max(std::abs(exact.d[i]), std::abs(exact.value)))
              << length << " " << velocity << " " << pennation << " " << i;
        }
      }
    }
  }
}

}  // namespace
}  // namespace sinew
