#include "problems/contact/load/pressure.h"

#include <cmath>

#include "problems/contact/effects.h"

namespace sinew {
namespace {

// With the compression z of the bed and q = C p / z, what the floor yields per unit of it, z (1 + q) = x. Of
// y = log q the equation of the bed is
//
//   y + n log(1 + e^y) = c,  c = log(C k (1 + c v)) + n log(x / x0),
//
// with a slope between 1 and 1 + n > 0. It starts at the nearer of its two straight asymptotes, at most |n|
// log 2 off; Halley's steps converge with the third power.
double LogYield(double right_side, double exponent) {
  double y = right_side > 0 ? right_side / (1 + exponent) : right_side;
  for (int i = 0; i < 60; ++i) {
    const double yield = std::exp(y);
    const double share = yield / (1 + yield);
    const double excess = y + exponent * std::log1p(yield) - right_side;
    const double slope = 1 + exponent * share;
    const double curvature = exponent * share * (1 - share);
    const double step = excess / (slope - 0.5 * excess * curvature / slope);
    y -= step;
    if (std::abs(step) <= 1e-6) break;  // what is left is its third power: rounding
  }
  return y;
}

// The law of PressureAt without its linear damping.
Pressure PressureOfUndampedBed(const ElasticFoundation& bed, const BedEffects& effects, double depth,
                               double rate, bool by_exponent) {
  Pressure p;
  const double damping = 1 + bed.dissipation * rate;
  if (!(depth > 0) || !(damping > 0)) return p;
  const double log_depth = by_exponent || effects.exponent != 0 ? std::log(depth / kReferenceDepth) : 0;
  double yield = effects.compliance * bed.stiffness * damping;
  double bend = 1;  // (z / x0)^n
  if (effects.exponent != 0) {
    if (yield == 0) {
      bend = std::exp(effects.exponent * log_depth);
    } else {
      const double of_straight_bed = yield;
      yield = std::exp(LogYield(std::log(yield) + effects.exponent * log_depth, effects.exponent));
      bend = yield / of_straight_bed;
    }
  }
  const double z = depth / (1 + yield);
  const double elastic = z * bend;
  p.value = bed.stiffness * elastic * damping;

  // dp = P_z dz + P_q dq with dz = -d(C p): whatever moves the bed alone moves p by `felt` of it.
  const double by_compression = (1 + effects.exponent) * bed.stiffness * bend * damping;
  const double felt = 1 / (1 + effects.compliance * by_compression);
  p.by_depth = by_compression * felt;
  p.by_rate = bed.dissipation * bed.stiffness * elastic * felt;
  p.by_stiffness = elastic * damping * felt;
  p.by_dissipation = rate * bed.stiffness * elastic * felt;
  if (by_exponent) p.by_exponent = p.value * (log_depth - std::log1p(yield)) * felt;
  p.by_compliance = -p.by_depth * p.value;
  return p;
}

}  // namespace

Pressure PressureOfBentBed(const ElasticFoundation& bed, const BedEffects& effects, double depth, double rate,
                           bool by_exponent) {
  const double damping = 1 + bed.dissipation * rate;
  if (!(depth > 0) || !(damping > 0)) return {};
  // What the dashpot beside the springs presses the floor down by is no depth of theirs.
  const double damped = effects.damping * rate;
  const double left = depth - effects.compliance * damped;
  if (!(left > 0)) {
    Pressure p;
    p.value = depth / effects.compliance;
    p.by_depth = 1 / effects.compliance;
    p.by_compliance = -p.value / effects.compliance;
    return p;
  }
  Pressure p = PressureOfUndampedBed(bed, effects, left, rate, by_exponent);
  p.value += damped;
  if (!(p.value > 0)) return {};
  const double felt = 1 - effects.compliance * p.by_depth;  // of a pressure beside the springs
  p.by_rate += effects.damping * felt;
  p.by_damping = rate * felt;
  p.by_compliance -= p.by_depth * damped;
  return p;
}

}  // namespace sinew
