// A sole that gives way horizontally: against equations solved by hand.
#include "problems/contact/load/sole_shear.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>

#include "base/constants.h"
#include "base/random.h"
#include "problems/contact/load/spring_force.h"

namespace sinew {
namespace {

// Force of one patch: viscous friction.
auto Viscous(double coefficient, const Horizontal& foot) {
  return [coefficient, foot](const Horizontal& shear_velocity) -> SoleShear::Friction {
    const Horizontal slip = foot + shear_velocity;
    return {-coefficient * slip, -coefficient * HorizontalJacobian::Identity(),
            0.5 * coefficient * slip.squaredNorm()};
  };
}

// Friction that falls with the slip beyond the width: the potential has several minima.
auto Falling(double greatest, double left, double width, const Horizontal& foot) {
  return [=](const Horizontal& shear_velocity) -> SoleShear::Friction {
    const std::array<double, 3> mu{greatest, left, 0};
    const Horizontal slip = foot + shear_velocity;
    const FrictionPerSlip law = FrictionPerSlipAt(slip.norm(), width);
    const double drag = mu[0] * law.value[0] + mu[1] * law.value[1];
    const double slope = mu[0] * law.slope[0] + mu[1] * law.slope[1];
    return {-drag * slip, -drag * HorizontalJacobian::Identity() - slope * slip * slip.transpose(),
            FrictionPotentialAt(slip.norm(), width, mu)};
  };
}

// What friction does to one patch during an instant. @return its force
Horizontal Advance(const std::function<SoleShear::Friction(const Horizontal&)>& friction, SoleShear& shear) {
  constexpr double kSolved = 1e-7;  // [m/s], where the equation has a slope of up to 1e5
  Horizontal shear_velocity;
  EXPECT_TRUE(shear.Solve(friction, shear_velocity));
  const SoleShear::Friction found = friction(shear_velocity);
  EXPECT_LT((shear_velocity - shear.compliance() * shear.ForceRate(found.force)).norm(), kSolved);
  shear.Accept(shear_velocity, found.force, found.by_slip);
  return found.force;
}

TEST(SoleShear, FrictionIsTheSlopeOfItsPotential) {
  constexpr double kStep = 1e-6;
  constexpr double kTolerance = 1e-7;
  const std::array<double, 3> mu{0.9, 0.6, 0.4};
  for (const double slip : {0.001, 0.0099, 0.0101, 0.03, 0.5}) {
    const FrictionPerSlip law = FrictionPerSlipAt(slip, 0.01);
    const double friction = slip * (mu[0] * law.value[0] + mu[1] * law.value[1] + mu[2] * law.value[2]);
    const double difference =
        (FrictionPotentialAt(slip + kStep, 0.01, mu) - FrictionPotentialAt(slip - kStep, 0.01, mu)) /
        (2 * kStep);
    EXPECT_NEAR(difference, friction, kTolerance) << slip;
  }
}

// Spring and dashpot in series: after a step of the foot's velocity the force grows as 1 - exp(-t / (C d)).
TEST(SoleShear, ViscousFrictionLagsByComplianceTimesDamping) {
  constexpr double kDamping = 2000;     // [N s/m]
  constexpr double kCompliance = 2e-5;  // [m/N]: 40 ms
  const Horizontal foot(0.1, -0.05);
  for (const double step : {0.002, 0.001}) {
    SoleShear shear;
    shear.Begin(kCompliance);
    double worst = 0;
    for (int i = 0; i * step < 0.2; ++i) {
      const double time = 1 + i * step;
      shear.Next(time);
      // At rest at first.
      const auto friction = Viscous(kDamping, i == 0 ? Horizontal::Zero() : foot);
      const Horizontal force = Advance(friction, shear);
      const Horizontal expected = -kDamping * foot * (1 - std::exp(-i * step / (kDamping * kCompliance)));
      worst = std::max(worst, (force - expected).norm());
    }
    std::printf("steps of %.3f s: %.3f N off\n", step, worst);
    // The first step is of first order, and half a step late.
    EXPECT_LT(worst, 0.6 * step / (kDamping * kCompliance) * kDamping * foot.norm());
  }
}

TEST(SoleShear, AnyStepsFollowASmoothForce) {
  constexpr double kDamping = 2000;
  constexpr double kCompliance = 1e-5;  // 20 ms
  constexpr double kFrequency = 2 * kPi;
  constexpr double kTau = kDamping * kCompliance;
  const auto foot_at = [](double t) { return Horizontal(0.1 * std::sin(kFrequency * t), 0); };
  const auto worst_of = [&](double mean_step) {
    Random random(3);
    SoleShear shear;
    shear.Begin(kCompliance);
    double worst = 0;
    for (double t = 0; t < 2; t += mean_step * random.Uniform(0.7, 1.3)) {
      shear.Next(t);
      const Horizontal force = Advance(Viscous(kDamping, foot_at(t)), shear);
      if (t < 0.5) continue;  // what began at rest has faded
      const double wt = kFrequency * kTau;
      const double expected =
          -kDamping * 0.1 / (1 + wt * wt) * (std::sin(kFrequency * t) - wt * std::cos(kFrequency * t));
      worst = std::max(worst, std::abs(force.x() - expected));
    }
    return worst;
  };
  const double coarse = worst_of(1.0 / 60);
  const double fine = worst_of(1.0 / 240);
  std::printf("of 200 N: %.3f N off with steps of 1/60 s, %.3f N with 1/240 s\n", coarse, fine);
  EXPECT_LT(coarse, 1);
  EXPECT_LT(fine, coarse / 10) << "second order";
}

// Friction that falls with the slip has several answers: one is found, and it is one.
TEST(SoleShear, FindsAnAnswerWhereFrictionFalls) {
  Random random(4);
  for (int round = 0; round < 300; ++round) {
    const double compliance = std::pow(10, random.Uniform(-8, -3));
    const double greatest = random.Uniform(50, 1000);
    const double left = greatest * random.Uniform(0, 1);
    SoleShear shear;
    shear.Begin(compliance);
    const double step = std::pow(10, random.Uniform(-4, -1.5));
    double direction = random.Uniform(0, 6);
    for (int i = 0; i < 40; ++i) {
      shear.Next(i * step);
      direction += random.Uniform(-0.5, 0.5);
      const Horizontal foot = 0.2 * std::sin(0.4 * i) * Horizontal(std::cos(direction), std::sin(direction));
      Advance(Falling(greatest, left, 0.01, foot), shear);
      ASSERT_FALSE(HasFailure()) << "round " << round << ", instant " << i;
    }
  }
}

}  // namespace
}  // namespace sinew
