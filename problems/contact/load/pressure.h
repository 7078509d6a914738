// The pressure under one spring with every contact effect in it, and its exact derivatives.
#pragma once

#include "models/contact/elastic_foundation.h"

namespace sinew {

/// What bends the law of the springs; all 0 at the null.
struct BedEffects {
  double exponent = 0;    ///< n [1, > -1]
  double compliance = 0;  ///< C of the floor under the bed [m3/N, >= 0]
  double damping = 0;     ///< d [N s/m3, >= 0]
};

struct Pressure {
  double value = 0;  ///< p [Pa]
  double by_depth = 0;
  double by_rate = 0;
  double by_stiffness = 0;
  double by_dissipation = 0;
  double by_exponent = 0;
  double by_compliance = 0;
  double by_damping = 0;
};

/// PressureAt for every bed.
[[nodiscard]] Pressure PressureOfBentBed(const ElasticFoundation& bed, const BedEffects& effects,
                                         double depth, double rate, bool by_exponent);

/// p solves
///
///   p = k x0 ((x - C p) / x0)^(1 + n) (1 + c v) + d v
///
/// with x0 = kReferenceDepth: a bed that is compressed by what the floor beneath it leaves of the depth x.
/// The rate v is that of the whole depth, so that with d = 0 C = 0 or n = 0 have the closed forms k x0
/// (x/x0)^(1+n) (1 + c v) and k x (1 + c v) / (1 + k C (1 + c v)). No more than x / C: then the floor takes
/// the whole depth. Zero with zero derivatives for x <= 0, 1 + c v <= 0 or p <= 0: a spring has no tension.
/// @param depth x [m]; @param rate v [m/s]; @param by_exponent Pressure::by_exponent is wanted: a logarithm
[[nodiscard]] inline Pressure PressureAt(const ElasticFoundation& bed, const BedEffects& effects,
                                         double depth, double rate, bool by_exponent) {
  if (by_exponent || effects.exponent != 0 || effects.compliance != 0 || effects.damping != 0)
    return PressureOfBentBed(bed, effects, depth, rate, by_exponent);
  // The same without its divisions, to the last bit.
  Pressure p;
  const double damping = 1 + bed.dissipation * rate;
  if (!(depth > 0) || !(damping > 0)) return p;
  p.value = bed.stiffness * depth * damping;
  p.by_depth = bed.stiffness * damping;
  p.by_rate = bed.dissipation * bed.stiffness * depth;
  p.by_stiffness = depth * damping;
  p.by_dissipation = rate * bed.stiffness * depth;
  p.by_compliance = -p.by_depth * p.value;
  p.by_damping = rate;
  return p;
}

}  // namespace sinew
