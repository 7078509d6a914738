#include "problems/contact/pressure.h"

#include <algorithm>
#include <cmath>

#include "problems/contact/effects.h"

namespace sinew {
namespace {

// Compression z of the bed: z + give (z / x0)^(1 + n) = depth, give = C k x0 (1 + c v) [m]. The left side
// grows with z, is convex for n > 0 and concave for n < 0, so Newton's steps from a point on the right side
// of the root stay there: above it for n > 0, below it for n < 0.
double Compression(double depth, double give, double exponent) {
  if (give == 0) return depth;
  if (exponent == 0) return depth / (1 + give / kReferenceDepth);
  const double power = 1 + exponent;
  const double share = exponent > 0 ? 1 : 0.5;
  double z = std::min(share * depth, kReferenceDepth * std::pow(share * depth / give, 1 / power));
  // Quadratic convergence: after a step of 1e-8 what is left is its square, and smaller steps are rounding,
  // which would play on to the bound.
  for (int i = 0; i < 60; ++i) {
    const double floor = give * std::pow(z / kReferenceDepth, power);
    const double step = (z + floor - depth) / (1 + power * floor / z);
    z -= step;
    if (std::abs(step) <= 1e-8 * z) break;
  }
  return z;
}

}  // namespace

Pressure PressureAt(const ElasticFoundation& bed, const BedEffects& effects, double depth, double rate) {
  Pressure p;
  const double damping = 1 + bed.dissipation * rate;
  if (!(depth > 0) || !(damping > 0)) return p;
  const double give = effects.compliance * bed.stiffness * kReferenceDepth * damping;
  const double z = Compression(depth, give, effects.exponent);
  const double power = 1 + effects.exponent;
  const double bend = effects.exponent == 0 ? 1 : std::pow(z / kReferenceDepth, effects.exponent);
  p.value = bed.stiffness * z * bend * damping;

  // dp = P_z dz + P_q dq with dz = -d(C p): whatever moves the bed alone moves p by `felt` of it.
  const double by_compression = power * p.value / z;
  const double felt = 1 / (1 + effects.compliance * by_compression);
  p.by_depth = by_compression * felt;
  p.by_rate = bed.dissipation * p.value / damping * felt;
  p.by_stiffness = p.value / bed.stiffness * felt;
  p.by_dissipation = rate * p.value / damping * felt;
  p.by_exponent = p.value * std::log(z / kReferenceDepth) * felt;
  p.by_compliance = -by_compression * p.value * felt;
  return p;
}

}  // namespace sinew
