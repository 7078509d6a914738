// Fibre length with an elastic tendon: equilibrium of the forces of fibre and tendon.
//
//   f_T((lmt - l cos(phi)) / lst - 1) F0 delta = F_m(l, v, a) cos(phi)
//
// The velocity is a linear function of the unknown length, v = rate l + past, which covers the static
// equilibrium (both 0), every implicit one-stage integrator, and the derivative of a spline that ends here.
#pragma once

#include <cmath>

#include "base/error.h"
#include "models/muscle/hill_muscle.h"

namespace sinew {

template <class T>
struct Fibre {
  T length{0.0};        ///< [m]
  T velocity{0.0};      ///< [m/s]
  T tendon_force{0.0};  ///< [N]
};

template <class T>
struct FibreVelocity {
  double rate = 0;  ///< [1/s, >= 0]
  T past{0.0};      ///< [m/s]
};

/// Safeguarded Newton search in double precision. @param guess [m]; 0: none
/// Errors: no equilibrium between a fibre of zero length and a slack tendon.
Result<double> EquilibriumLength(const MuscleCurves& curves, const HillMuscle<double>& muscle,
                                 double unit_length, double activation, const FibreVelocity<double>& velocity,
                                 double guess);

namespace elastic_tendon {

/// If both fibre and tendon forces are zero, the length is undetermined: a spring of this stiffness [F0 per
/// l0] holds the fibre where a rigid tendon would.
constexpr double kHold = 1e-6;

/// Force of the fibre less that of the tendon [N].
template <class T, class U>
T Imbalance(const MuscleCurves& curves, const HillMuscle<T>& muscle, const U& unit_length, const T& length,
            const T& velocity, const T& activation) {
  const T cosine = PennationCosine(muscle, Sin(muscle.pennation), length);
  const T fibre = FibreForce(curves, muscle, length, velocity, activation) * cosine;
  const T rigid = RigidFibreLength(muscle, unit_length);
  const T hold = kHold * muscle.isometric_force * muscle.strength * (length - rigid) / muscle.optimal_length;
  return fibre + hold - TendonForce(curves, muscle, unit_length, length, cosine);
}

/// The same muscle in another kind of number, without derivatives.
template <class To, class T>
HillMuscle<To> Plain(const HillMuscle<T>& m) {
  return {Value(m.optimal_length), Value(m.tendon_slack_length), Value(m.isometric_force),
          Value(m.strength),       Value(m.pennation),           Value(m.length_change),
          Value(m.damping),        Value(m.largest_velocity),    Value(m.compliance),
          Value(m.active_gain)};
}

}  // namespace elastic_tendon

/// With exact derivatives (implicit function theorem). Errors: as EquilibriumLength.
template <class T, class U>
Result<Fibre<T>> Equilibrium(const MuscleCurves& curves, const HillMuscle<T>& muscle, const U& unit_length,
                             const T& activation, const FibreVelocity<T>& velocity, double guess) {
  using namespace elastic_tendon;  // NOLINT(google-build-using-namespace): this function's own helpers
  SINEW_ASSIGN(const double length,
               EquilibriumLength(curves, Plain<double>(muscle), Value(unit_length), Value(activation),
                                 {velocity.rate, Value(velocity.past)}, guess));
  Fibre<T> fibre;
  fibre.length = length;
  if constexpr (!std::is_same_v<T, double>) {
    // One Newton step in dual numbers: the value is at rest, the derivatives move.
    const Dual<1> moving = Dual<1>::Variable(length, 0);
    const Dual<1> slope =
        Imbalance(curves, Plain<Dual<1>>(muscle), Value(unit_length), moving,
                  velocity.rate * moving + Value(velocity.past), Dual<1>(Value(activation)));
    const T still = Imbalance(curves, muscle, unit_length, T(length),
                              velocity.rate * T(length) + velocity.past, activation);
    fibre.length = length - Tangent(still) / slope.d[0];
  }
  fibre.velocity = velocity.rate * fibre.length + velocity.past;
  const T cosine = PennationCosine(muscle, Sin(muscle.pennation), fibre.length);
  fibre.tendon_force = TendonForce(curves, muscle, unit_length, fibre.length, cosine);
  return fibre;
}

/// The fibre's length as a state: backward differences of second order, from the static equilibrium on.
/// Stable whatever the step, and without activation too as long as the fibre is damped.
template <class T>
class ElasticFibre {
 public:
  ElasticFibre(const MuscleCurves& curves, const HillMuscle<T>& muscle) : curves_(curves), muscle_(muscle) {}

  /// @param time [s], increasing from call to call. Errors: as EquilibriumLength.
  template <class U>
  Result<Fibre<T>> Next(double time, const U& unit_length, const T& activation) {
    FibreVelocity<T> velocity;
    if (steps_ == 1) {
      velocity.rate = 1 / (time - time_);
      velocity.past = -velocity.rate * length_;
    } else if (steps_ > 1) {
      const double h = time - time_;
      const double ratio = h / (time_ - time_before_);
      velocity.rate = (1 + 2 * ratio) / (1 + ratio) / h;
      velocity.past = (ratio * ratio / (1 + ratio) * length_before_ - (1 + ratio) * length_) / h;
    }
    SINEW_ASSIGN(const auto fibre, Equilibrium(curves_, muscle_, unit_length, activation, velocity,
                                               steps_ > 0 ? Value(length_) : 0));
    time_before_ = time_;
    length_before_ = length_;
    time_ = time;
    length_ = fibre.length;
    ++steps_;
    return fibre;
  }

 private:
  const MuscleCurves& curves_;
  const HillMuscle<T>& muscle_;
  int steps_ = 0;
  double time_ = 0;
  double time_before_ = 0;
  T length_{0.0};
  T length_before_{0.0};
};

}  // namespace sinew
