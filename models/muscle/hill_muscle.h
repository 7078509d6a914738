// A Hill-type muscle and its tendon. SCIENCE section 3; thesis eq 4.2 to 4.4.
//
//   F_m = F0 delta (f_A(l / l0(a)) f_V(v / (vmax l0)) a + f_P(l / l0) + d v / (vmax l0)),
//   l0(a) = l0 (lambda (1 - a) + 1),  tendon force F_m cos(phi),  l sin(phi) = l0 sin(phi0)
#pragma once

#include "models/muscle/muscle_curve.h"

namespace sinew {

/// The curves that all muscles of a subject share; of normalised length, velocity and strain.
struct MuscleCurves {
  MuscleCurve active_force_length;
  MuscleCurve passive_force_length;
  MuscleCurve force_velocity;  ///< positive velocity: lengthening
  MuscleCurve tendon_force_strain;

  /// The points that come with CEINMS, smooth.
  static MuscleCurves Default();
};

/// Parameters of one muscle; T is double or Dual.
template <class T>
struct HillMuscle {
  T optimal_length{0.1};       ///< l0 [m, > 0]
  T tendon_slack_length{0.2};  ///< [m, > 0]
  T isometric_force{1000.0};   ///< F0 [N, > 0]
  T strength{1.0};             ///< delta [1, > 0]
  T pennation{0.0};            ///< phi0, at optimal length [rad, 0..1.4]
  T length_change{0.15};       ///< lambda [1, 0..0.2]
  T damping{0.1};              ///< d [1, >= 0]
  T largest_velocity{10.0};    ///< vmax [optimal lengths per second, > 0]
  T compliance{1.0};           ///< factor on the strain of the tendon [1, > 0]
  T active_gain{1.0};          ///< factor on the active force, see ForceHistory [1, >= 0]
};

/// A fibre has at least this length, as a share of the optimal one: below 0.4 no curve has force.
constexpr double kShortestFibre = 0.05;
/// The sine of the pennation angle is at most that: the fibre never stands across the tendon.
constexpr double kLargestSine = 0.99;

/// cos(phi) of a fibre of this length [m].
template <class T>
[[nodiscard]] T PennationCosine(const HillMuscle<T>& muscle, const T& sine_at_optimal, const T& length) {
  const T sine = muscle.optimal_length * sine_at_optimal / length;
  if (!(Value(sine) < kLargestSine)) return T(std::sqrt(1 - kLargestSine * kLargestSine));
  return Sqrt(1.0 - sine * sine);
}

/// Fibre length [m] with a rigid tendon: l = sqrt((l0 sin(phi0))^2 + (lmt - lst)^2).
/// @param sine of phi0 @param unit_length [m] of muscle and tendon
template <class T, class U>
[[nodiscard]] T RigidFibreLength(const HillMuscle<T>& muscle, const T& sine, const U& unit_length) {
  const T thickness = muscle.optimal_length * sine;
  const T along = unit_length - muscle.tendon_slack_length;
  const T square = thickness * thickness + along * along;
  const T shortest = kShortestFibre * muscle.optimal_length;
  if (!(Value(square) > Value(shortest) * Value(shortest))) return shortest;
  return Sqrt(square);
}

template <class T, class U>
[[nodiscard]] T RigidFibreLength(const HillMuscle<T>& muscle, const U& unit_length) {
  return RigidFibreLength(muscle, T(Sin(muscle.pennation)), unit_length);
}

/// Force of the fibre [N], along itself.
/// @param length [m] @param velocity [m/s, positive: lengthening] @param activation [0..1]
template <class T>
[[nodiscard]] T FibreForce(const MuscleCurves& curves, const HillMuscle<T>& muscle, const T& length,
                           const T& velocity, const T& activation) {
  const T per_length = 1.0 / muscle.optimal_length;
  const T stretch = length * per_length;
  const T optimal = 1.0 + muscle.length_change * (1.0 - activation);
  const T speed = velocity * per_length / muscle.largest_velocity;
  const T active = curves.active_force_length(stretch / optimal) * curves.force_velocity(speed) * activation *
                   muscle.active_gain;
  return muscle.isometric_force * muscle.strength *
         (active + curves.passive_force_length(stretch) + muscle.damping * speed);
}

/// Force of the fibre along the tendon [N] and its partial derivatives [N per unit of each number]: one
/// number moves, all others stay.
struct Pull {
  double value = 0;
  double length = 0;
  double velocity = 0;
  double activation = 0;
  double optimal_length = 0;  ///< the thickness staying
  double thickness = 0;       ///< optimal length times the sine of the pennation [m]
  double strength = 0;        ///< isometric force times strength [N]
  double length_change = 0;
  double damping = 0;
  double largest_velocity = 0;
  double active_gain = 0;
  double cosine = 0;            ///< of the pennation angle, and its own derivatives
  double cosine_by_length = 0;  ///< [1/m]
  double cosine_by_thickness = 0;
};

/// FibreForce times PennationCosine, the value to the last bit; at a length, velocity and activation.
[[nodiscard]] Pull PullAt(const MuscleCurves& curves, const HillMuscle<double>& muscle, double sine,
                          double length, double velocity, double activation);

/// What of a quantity's derivative the muscle's own numbers bring, by its partial derivatives.
template <class Partials, class T>
[[nodiscard]] auto ByMuscle(const Partials& by, const HillMuscle<T>& muscle, const T& thickness,
                            const T& strength, std::size_t lane) {
  return by.optimal_length * muscle.optimal_length.d[lane] + by.thickness * thickness.d[lane] +
         by.strength * strength.d[lane] + by.length_change * muscle.length_change.d[lane] +
         by.damping * muscle.damping.d[lane] + by.largest_velocity * muscle.largest_velocity.d[lane] +
         by.active_gain * muscle.active_gain.d[lane];
}

/// The same muscle without derivatives.
template <class T>
[[nodiscard]] HillMuscle<double> Plain(const HillMuscle<T>& m) {
  return {Value(m.optimal_length), Value(m.tendon_slack_length), Value(m.isometric_force),
          Value(m.strength),       Value(m.pennation),           Value(m.length_change),
          Value(m.damping),        Value(m.largest_velocity),    Value(m.compliance),
          Value(m.active_gain)};
}

/// Force of the tendon [N] at this length of the fibre.
template <class T, class U>
[[nodiscard]] T TendonForce(const MuscleCurves& curves, const HillMuscle<T>& muscle, const U& unit_length,
                            const T& fibre_length, const T& cosine) {
  const T strain = (unit_length - fibre_length * cosine) / muscle.tendon_slack_length - 1.0;
  return muscle.isometric_force * muscle.strength * curves.tendon_force_strain(strain / muscle.compliance);
}

}  // namespace sinew
