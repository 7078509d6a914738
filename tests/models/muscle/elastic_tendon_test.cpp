#include "models/muscle/elastic_tendon.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "tests/models/muscle/soleus.h"

namespace sinew {
namespace {

double UnitLength(double t) {
  return 0.3 + 0.01 * std::sin(6 * t);
}
double Activation(double t) {
  return 0.4 - 0.35 * std::cos(9 * t);
}

TEST(ElasticTendonTest, FibreAndTendonForcesAreEqual) {
  const auto muscle = Soleus();
  for (const double a : {0.01, 0.3, 1.0}) {
    for (const double unit : {0.29, 0.3, 0.31}) {
      const auto fibre = EquilibriumSearch<double>(Curves(), muscle).Next(unit, a, {}, 0);
      ASSERT_TRUE(fibre) << fibre.error().message;
      const double cosine = PennationCosine(muscle, std::sin(0.436), fibre->length);
      EXPECT_NEAR(FibreForce(Curves(), muscle, fibre->length, 0.0, a) * cosine, fibre->tendon_force, 0.01);
      EXPECT_GE(fibre->length, 0);
    }
  }
}

// A stiff tendon is a rigid one: twice as stiff, half as far from it.
TEST(ElasticTendonTest, ApproachesTheRigidTendonWithStiffness) {
  const auto muscle = Soleus();
  const double rigid = RigidFibreLength(muscle, 0.3);
  std::vector<double> away;
  for (const double stiffer : {10.0, 20.0, 40.0}) {
    MuscleCurves curves = Curves();
    std::vector<double> strain{-1, 0, 0.02 / stiffer, 1};
    curves.tendon_force_strain =
        *MuscleCurve::Smooth(strain, {0, 0, 0.5, 0.5 + (1 - strain[2]) * 25 * stiffer}, 1e-3 / stiffer);
    const auto fibre = EquilibriumSearch<double>(curves, muscle).Next(0.3, 0.7, {}, 0);
    ASSERT_TRUE(fibre);
    away.push_back(rigid - fibre->length);
  }
  EXPECT_GT(away[0], 0);
  EXPECT_NEAR(away[0] / away[1], 2, 0.1);
  EXPECT_NEAR(away[1] / away[2], 2, 0.05);
}

// Of second order in the step.
TEST(ElasticTendonTest, IntegratesTheFibre) {
  const auto muscle = Soleus();
  const auto force = [&](int steps) {
    ElasticFibre<double> state(Curves(), muscle);
    double last = 0;
    for (int i = 0; i <= steps; ++i) {
      const double t = 0.5 * i / steps;
      const auto fibre = state.Next(t, UnitLength(t), Activation(t));
      EXPECT_TRUE(fibre);
      last = fibre->tendon_force;
    }
    return last;
  };
  const double fine = force(40000);
  const double coarse = force(250);
  const double half = force(500);
  EXPECT_NEAR(coarse, fine, 0.01 * fine);
  EXPECT_NEAR((coarse - fine) / (half - fine), 4, 0.8);
}

// Every parameter of the muscle, through the whole history.
TEST(ElasticTendonTest, DerivativesAreThoseOfDifferences) {
  constexpr int kLanes = 9;
  const std::array<double, kLanes> at{0.05, 0.25, 3549, 1.1, 0.436, 0.15, 0.1, 10, 1};
  const auto run = [&](const auto& p, auto zero) {
    using T = decltype(zero);
    const HillMuscle<T> muscle{p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7]};
    ElasticFibre<T> state(Curves(), muscle);
    T force = zero;
    for (int i = 0; i <= 60; ++i) {
      const auto fibre = state.Next(0.005 * i, UnitLength(0.005 * i), Activation(0.005 * i) * p[8]);
      EXPECT_TRUE(fibre);
      force = fibre->tendon_force;
    }
    return force;
  };
  std::array<Dual<kLanes>, kLanes> p;
  for (int i = 0; i < kLanes; ++i) p[i] = Dual<kLanes>::Variable(at[static_cast<std::size_t>(i)], i);
  const auto exact = run(p, Dual<kLanes>(0));
  EXPECT_NEAR(exact.value, run(at, 0.0), 1e-7);
  for (std::size_t i = 0; i < at.size(); ++i) {
    auto up = at;
    auto down = at;
    const double step = 1e-5 * at[i];
    up[i] += step;
    down[i] -= step;
    const double slope = (run(up, 0.0) - run(down, 0.0)) / (2 * step);
    EXPECT_NEAR(exact.d[i], slope, 1e-4 * std::max(std::abs(slope), 1.0)) << i;
  }
}

// Near slack, fibre and tendon are so soft that the last step of a search changes their slope.
TEST(ElasticTendonTest, DerivativesDoNotDependOnWhereTheSearchBegan) {
  Random random(5);
  for (int i = 0; i < 3000; ++i) {
    HillMuscle<Dual<2>> muscle;
    muscle.optimal_length = Dual<2>::Variable(random.Uniform(0.03, 0.15), 0);
    muscle.tendon_slack_length = Dual<2>::Variable(random.Uniform(0.02, 0.4), 1);
    muscle.pennation = random.Uniform(0, 0.4);
    muscle.damping = i % 2 == 0 ? 0 : 0.1;
    const Dual<2> a(i % 3 == 0 ? random.Uniform(0, 0.01) : random.Uniform(0, 1));
    const double unit =
        (muscle.optimal_length.value + muscle.tendon_slack_length.value) * random.Uniform(0.95, 1.1);
    EquilibriumSearch<Dual<2>> search(Curves(), muscle);
    const auto from_nowhere = search.Length(unit, a, {}, 0);
    ASSERT_TRUE(from_nowhere) << from_nowhere.error().message;
    for (const double away : {1e-10, 1e-7, 1e-4}) {
      const auto nearby =
          search.Length(unit, a, {}, from_nowhere->value + away * muscle.optimal_length.value);
      ASSERT_TRUE(nearby) << nearby.error().message;
      EXPECT_NEAR(nearby->value, from_nowhere->value, 1e-12) << i;
      for (int k = 0; k < 2; ++k)
        EXPECT_NEAR(nearby->d[k], from_nowhere->d[k], 1e-7 * std::max(1.0, std::abs(nearby->d[k]))) << i;
    }
  }
}

// Slack tendons, fibres at their limits, no activation at all, absurd parameters: finite, or one sentence.
TEST(ElasticTendonTest, FiniteEverywhere) {
  Random random(4);
  int refused = 0;
  for (int i = 0; i < 20000; ++i) {
    const bool absurd = i % 2 == 1;
    const auto draw = [&](double low, double high) {
      return absurd ? low * 0.2 + (high * 3 - low * 0.2) * random.Uniform(0, 1) : random.Uniform(low, high);
    };
    HillMuscle<Dual<2>> muscle;
    muscle.optimal_length = Dual<2>::Variable(draw(0.03, 0.15), 0);
    muscle.tendon_slack_length = Dual<2>::Variable(draw(0.02, 0.4), 1);
    muscle.pennation = std::min(draw(0, 0.5), 1.4);
    muscle.damping = i % 5 == 0 ? 0 : 0.1;
    const double a = i % 7 == 0 ? 0 : i % 7 == 1 ? 1 : random.Uniform(0, 1);
    const double unit = (muscle.optimal_length.value + muscle.tendon_slack_length.value) *
                        random.Uniform(absurd ? 0.1 : 0.8, absurd ? 3 : 1.3);
    const FibreVelocity<Dual<2>> velocity =
        i % 3 == 0 ? FibreVelocity<Dual<2>>{}
                   : FibreVelocity<Dual<2>>{
                         100, Dual<2>(-100 * muscle.optimal_length.value * random.Uniform(0.5, 1.5))};
    const auto fibre = EquilibriumSearch<Dual<2>>(Curves(), muscle).Next(unit, Dual<2>(a), velocity, 0);
    if (!fibre) {
      EXPECT_THAT(fibre.error().message, testing::HasSubstr("no equilibrium"));
      EXPECT_TRUE(absurd) << fibre.error().message;
      ++refused;
      continue;
    }
    EXPECT_TRUE(std::isfinite(fibre->length.value) && std::isfinite(fibre->tendon_force.value)) << i;
    EXPECT_TRUE(std::isfinite(fibre->tendon_force.d[0]) && std::isfinite(fibre->tendon_force.d[1])) << i;
    EXPECT_GT(fibre->length.value, 0);
  }
  EXPECT_LT(refused, 2000);
}

}  // namespace
}  // namespace sinew
