// What a compliant tendon changes in the force of a muscle whose tendon was taken as rigid.
#pragma once

#include <cmath>
#include <vector>

#include "base/error.h"
#include "models/muscle/elastic_tendon.h"

namespace sinew {
namespace tendon_compliance {

// Below, the strain of the tendon is that of the force with a rigid one: right to the square of this.
constexpr double kNearlyRigid = 1e-3;
// The curve's strain at lower forces [F0] is taken as proportional to the force: its slope at 0 may be
// infinite.
constexpr double kLowForce = 1e-3;

/// Strain at a normalised force [0..], by bisection of the curve.
inline double StrainAt(const MuscleCurve& curve, double force) {
  double low = 0;
  double high = 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (curve(middle) < force ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

template <class T>
T Strain(const MuscleCurve& curve, const T& force) {
  if (!(Value(force) > 0)) return T(0.0);
  if (Value(force) < kLowForce) return force * (StrainAt(curve, kLowForce) / kLowForce);
  const double strain = StrainAt(curve, Value(force));
  return strain + Tangent(force) * (1 / curve.At(strain).slope);
}

/// Fibre velocities by backward differences of second order, as those of ElasticFibre.
template <class T>
T BackwardSlope(const std::vector<double>& time, const std::vector<T>& lengths, std::size_t i) {
  if (i == 0) return T(0.0);
  const double h = time[i] - time[i - 1];
  if (i == 1) return (lengths[1] - lengths[0]) * (1 / h);
  const double ratio = h / (time[i - 1] - time[i - 2]);
  return ((1 + 2 * ratio) / (1 + ratio) * lengths[i] - (1 + ratio) * lengths[i - 1] +
          ratio * ratio / (1 + ratio) * lengths[i - 2]) *
         (1 / h);
}

/// Force with the fibre of a rigid tendon that is longer by `extension` [N, m; empty: 0].
template <class T>
std::vector<T> ForceWithExtension(const MuscleCurves& curves, const HillMuscle<T>& muscle,
                                  const std::vector<double>& time, const std::vector<T>& unit_length,
                                  const std::vector<T>& activation, const std::vector<T>& extension) {
  const T sine = Sin(muscle.pennation);
  std::vector<T> lengths;
  std::vector<T> force;
  for (std::size_t i = 0; i < time.size(); ++i) {
    lengths.push_back(
        RigidFibreLength(muscle, extension.empty() ? unit_length[i] : T(unit_length[i] - extension[i])));
    force.push_back(FibreForce(curves, muscle, lengths[i], BackwardSlope(time, lengths, i), activation[i]) *
                    PennationCosine(muscle, sine, lengths[i]));
  }
  return force;
}

}  // namespace tendon_compliance

/// Adds to the force [N] of a rigid tendon what changes if the tendon's strain at a force is `compliance`
/// times that of the subject's curve: the force of an elastic tendon less that of a rigid one, both with the
/// fibre's velocity from backward differences. 0 changes nothing, to the last bit.
/// Errors: as ElasticFibre.
template <class T>
Status AddCompliance(const MuscleCurves& curves, HillMuscle<T> muscle, const T& compliance,
                     const std::vector<double>& time, const std::vector<T>& unit_length,
                     const std::vector<T>& activation, std::vector<T>& force) {
  using namespace tendon_compliance;  // NOLINT(google-build-using-namespace): this function's own helpers
  const std::vector<T> rigid = ForceWithExtension(curves, muscle, time, unit_length, activation, {});
  if (Value(compliance) < kNearlyRigid) {
    const T per_force = 1.0 / (muscle.isometric_force * muscle.strength);
    std::vector<T> extension;
    for (const T& pull : rigid)
      extension.push_back(compliance * muscle.tendon_slack_length *
                          Strain(curves.tendon_force_strain, pull * per_force));
    const std::vector<T> compliant =
        ForceWithExtension(curves, muscle, time, unit_length, activation, extension);
    for (std::size_t i = 0; i < force.size(); ++i) force[i] += compliant[i] - rigid[i];
    return {};
  }
  muscle.compliance = compliance;
  ElasticFibre<T> state(curves, muscle);
  for (std::size_t i = 0; i < force.size(); ++i) {
    const auto fibre = state.Next(time[i], unit_length[i], activation[i]);
    if (!fibre) return Fail("t = {:.4g} s: {}", time[i], fibre.error().message);
    force[i] += fibre->tendon_force - rigid[i];
  }
  return {};
}

}  // namespace sinew
