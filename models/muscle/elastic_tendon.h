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

namespace elastic_tendon {

/// If both fibre and tendon forces are zero, the length is undetermined: a spring of this stiffness [F0 per
/// l0] holds the fibre where a rigid tendon would.
constexpr double kHold = 1e-6;

/// Forces at one length of the fibre.
template <class T>
struct Balance {
  T imbalance{0.0};     ///< force of the fibre along the tendon less that of the tendon [N]
  T tendon_force{0.0};  ///< [N]
};

/// @param sine of the pennation angle
template <class T, class U>
Balance<T> BalanceAt(const MuscleCurves& curves, const HillMuscle<T>& muscle, const T& sine,
                     const U& unit_length, const T& length, const T& velocity, const T& activation) {
  const T cosine = PennationCosine(muscle, sine, length);
  const T fibre = FibreForce(curves, muscle, length, velocity, activation) * cosine;
  const T rigid = RigidFibreLength(muscle, sine, unit_length);
  const T hold = kHold * muscle.isometric_force * muscle.strength * (length - rigid) / muscle.optimal_length;
  const T tendon = TendonForce(curves, muscle, unit_length, length, cosine);
  return {fibre + hold - tendon, tendon};
}

/// Partial derivatives of the imbalance [N per unit of each number]; one number moves, all others stay.
struct Partials {
  double length = 0;  ///< of the fibre, the velocity moving along
  double velocity = 0;
  double activation = 0;
  double unit_length = 0;
  double optimal_length = 0;  ///< the thickness staying
  double thickness = 0;       ///< optimal length times the sine of the pennation
  double tendon_slack_length = 0;
  double strength = 0;  ///< largest force [N]
  double length_change = 0;
  double damping = 0;
  double largest_velocity = 0;
  double compliance = 0;
  double active_gain = 0;
};

/// The equilibrium in double precision, with the slope of the imbalance for the fibre's length.
class PlainSearch {
 public:
  PlainSearch(const MuscleCurves& curves, const HillMuscle<double>& muscle);

  /// Newton's method; safeguarded unless it converges at once. @param guess [m]; 0: none
  /// Errors: no equilibrium between a fibre of zero length and a slack tendon.
  Result<double> Length(double unit_length, double activation, const FibreVelocity<double>& velocity,
                        double guess);
  /// The sample that PartialsAt is asked about, where its length is known without a search.
  void Place(double unit_length, double activation, const FibreVelocity<double>& velocity);
  /// Of the sample that was searched or placed last. To be taken at the very length that was found: where
  /// fibre and tendon are nearly slack, the slope changes by a part of itself within the last step of the
  /// search.
  [[nodiscard]] Partials PartialsAt(double length) const;

  /// Of the muscle; for changes of its active gain.
  HillMuscle<double>& muscle() { return muscle_; }

 private:
  // Imbalance at a length; its slope into slope_.
  double At(double length);
  Result<double> Safeguarded(double guess);

  const MuscleCurves& curves_;
  HillMuscle<double> muscle_;
  double sine_ = 0;
  double thickness_ = 0;
  double per_length_ = 0;
  double per_speed_ = 0;
  double strength_ = 0;
  double hold_ = 0;
  // Of the sample.
  double unit_length_ = 0;
  double activation_ = 0;
  double per_optimal_ = 0;
  double rigid_ = 0;
  FibreVelocity<double> velocity_;
  double slope_ = 0;
};

}  // namespace elastic_tendon

/// Fibre lengths of one muscle in equilibrium, sample by sample, with exact derivatives (implicit function
/// theorem).
template <class T>
class EquilibriumSearch {
 public:
  EquilibriumSearch(const MuscleCurves& curves, const HillMuscle<T>& muscle)
      : curves_(curves),
        muscle_(muscle),
        sine_(Sin(muscle.pennation)),
        thickness_(muscle.optimal_length * sine_),
        strength_(muscle.isometric_force * muscle.strength),
        plain_(curves, Plain(muscle)) {}

  /// @param guess [m] as in PlainSearch. Errors: as PlainSearch.
  template <class U>
  Result<T> Length(const U& unit_length, const T& activation, const FibreVelocity<T>& velocity,
                   double guess) {
    plain_.muscle().active_gain = Value(muscle_.active_gain);
    SINEW_ASSIGN(const double length, plain_.Length(Value(unit_length), Value(activation),
                                                    {velocity.rate, Value(velocity.past)}, guess));
    return WithDerivatives(length, unit_length, activation, velocity);
  }

  /// The same where the length [m] is known from a search with these numbers.
  template <class U>
  T Known(double length, const U& unit_length, const T& activation, const FibreVelocity<T>& velocity) {
    if constexpr (!std::is_same_v<T, double>) {
      plain_.muscle().active_gain = Value(muscle_.active_gain);
      plain_.Place(Value(unit_length), Value(activation), {velocity.rate, Value(velocity.past)});
    }
    return WithDerivatives(length, unit_length, activation, velocity);
  }

  /// Length, velocity and force. Errors: as Length.
  template <class U>
  Result<Fibre<T>> Next(const U& unit_length, const T& activation, const FibreVelocity<T>& velocity,
                        double guess) {
    Fibre<T> fibre;
    SINEW_ASSIGN(fibre.length, Length(unit_length, activation, velocity, guess));
    fibre.velocity = velocity.rate * fibre.length + velocity.past;
    const T cosine = PennationCosine(muscle_, sine_, fibre.length);
    fibre.tendon_force = TendonForce(curves_, muscle_, unit_length, fibre.length, cosine);
    return fibre;
  }

 private:
  // Of the sample that plain_ was asked about.
  template <class U>
  T WithDerivatives(double length, const U& unit_length, const T& activation,
                    const FibreVelocity<T>& velocity) const {
    T moved(length);
    if constexpr (!std::is_same_v<T, double>) {
      const elastic_tendon::Partials by = plain_.PartialsAt(length);
      const double share = -1 / by.length;
      for (std::size_t i = 0; i < moved.d.size(); ++i) {
        moved.d[i] = share * (by.velocity * velocity.past.d[i] + by.activation * activation.d[i] +
                              by.tendon_slack_length * muscle_.tendon_slack_length.d[i] +
                              by.compliance * muscle_.compliance.d[i] +
                              ByMuscle(by, muscle_, thickness_, strength_, i));
      }
      if constexpr (!std::is_same_v<U, double>) {
        for (std::size_t i = 0; i < moved.d.size(); ++i)
          moved.d[i] += share * by.unit_length * unit_length.d[i];
      }
    }
    return moved;
  }

  const MuscleCurves& curves_;
  const HillMuscle<T>& muscle_;
  T sine_;
  T thickness_;
  T strength_;
  elastic_tendon::PlainSearch plain_;
};

/// The fibre's length as a state: backward differences of second order, from the static equilibrium on.
/// Stable whatever the step, and without activation too as long as the fibre is damped.
template <class T>
class ElasticFibre {
 public:
  ElasticFibre(const MuscleCurves& curves, const HillMuscle<T>& muscle) : search_(curves, muscle) {}

  /// @param time [s], increasing from call to call. Errors: as EquilibriumSearch.
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
    SINEW_ASSIGN(const auto fibre,
                 search_.Next(unit_length, activation, velocity, steps_ > 0 ? Value(length_) : 0));
    time_before_ = time_;
    length_before_ = length_;
    time_ = time;
    length_ = fibre.length;
    ++steps_;
    return fibre;
  }

 private:
  EquilibriumSearch<T> search_;
  int steps_ = 0;
  double time_ = 0;
  double time_before_ = 0;
  T length_{0.0};
  T length_before_{0.0};
};

}  // namespace sinew
