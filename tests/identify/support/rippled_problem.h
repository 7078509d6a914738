// A problem with a ripple of an unknown period, for tests of searches that try several of them.
#pragma once

#include <cmath>
#include <vector>

#include "base/constants.h"
#include "base/random.h"
#include "tests/identify/support/function_problem.h"

namespace sinew::rippled {

inline constexpr int kInstants = 400;
inline constexpr double kPeriod = 0.0731;
inline constexpr double kCos = 0.3;
inline constexpr double kSin = -0.2;
enum : int { kSlope, kRippleCos, kRippleSin, kRipplePeriod, kStep };

inline double Time(int i) {
  return static_cast<double>(i) / kInstants;
}

// A line with a ripple of an unknown period, and a step whose size is unknown and whose slope at the null is
// 0.
class Rippled final : public FunctionProblem {
 public:
  Rippled() {
    Add(BaseParameter("slope", "1", "of the line", -10, 10, 1));
    Add(EffectParameter("ripple_cos", "1", "of the ripple", -2, 2, 0, "ripple"));
    Add(EffectParameter("ripple_sin", "1", "of the ripple", -2, 2, 0, "ripple"));
    Parameter period = EffectParameter("ripple_period", "1", "of the ripple", 0.02, 1, 1, "ripple");
    period.start = 1;
    for (int cycles = 1; cycles <= 40; ++cycles) period.probes.push_back(1.0 / cycles);
    Add(period);
    Parameter step = EffectParameter("step", "1", "cubic", -1, 1, 0, "step");
    step.probes = {-0.5, 0.5};
    Add(step);
    Random random(3);
    std::vector<double> measured;
    for (int i = 0; i < kInstants; ++i) {
      const double angle = 2 * kPi * Time(i) / kPeriod;
      measured.push_back(2 * Time(i) + kCos * std::cos(angle) + kSin * std::sin(angle) +
                         1e-3 * random.Normal());
    }
    AddBlock("trial", measured, {0, 1, 2, 3, 4},
             [](const Vector& p, Eigen::Ref<Vector> values, Matrix* derivatives) -> Status {
               for (int i = 0; i < kInstants; ++i) {
                 const double t = Time(i);
                 const double late = i > kInstants / 2 ? 1 : 0;
                 const double angle = 2 * kPi * t / p[kRipplePeriod];
                 const double c = std::cos(angle);
                 const double s = std::sin(angle);
                 values[i] =
                     p[kSlope] * t + p[kRippleCos] * c + p[kRippleSin] * s + late * std::pow(p[kStep], 3);
                 if (derivatives == nullptr) continue;
                 (*derivatives)(i, kSlope) = t;
                 (*derivatives)(i, kRippleCos) = c;
                 (*derivatives)(i, kRippleSin) = s;
                 (*derivatives)(i, kRipplePeriod) =
                     (p[kRippleCos] * s - p[kRippleSin] * c) * angle / p[kRipplePeriod];
                 (*derivatives)(i, kStep) = 3 * late * p[kStep] * p[kStep];
               }
               return {};
             });
  }
  [[nodiscard]] const std::vector<Effect>& effects() const override { return effects_; }

 private:
  std::vector<Effect> effects_{
      {"ripple", Level::kRobot, "it ripples", "slow motion", {kRippleCos, kRippleSin, kRipplePeriod}},
      {"step", Level::kRobot, "it steps", "long motion", {kStep}}};
};

inline constexpr double kCostOfNoise = 0.5 * kInstants * 1e-6;

}  // namespace sinew::rippled
