// Forces of a bed of springs under a straight sole, summed over its strips. SCIENCE section 4.
//
//   strip   n = k a d (d / 5 mm)^e (1 - c v), never pulling, with Hollars friction
//
// Depth d and velocity of a strip are linear functions of its place x along the sole. So the derivatives of
// the sums follow from moments of the strips' own slopes, plain numbers, whatever the number of derivatives.
#pragma once

#include <cmath>

#include "base/dual_math.h"
#include "models/dynamometer/foot_geometry.h"

namespace sinew {

/// A quantity that is linear in the place along the sole.
template <class T>
struct AlongSole {
  T at_ankle{0.0};
  T per_x{0.0};
};

/// The law of one strip. T is double or Dual.
template <class T>
struct SoleLaw {
  T stiffness{1.0};    ///< of a strip: pressure per depth times its area [N/m, > 0]
  T dissipation{0.0};  ///< c [s/m, >= 0]
  T exponent{0.0};     ///< e [1, > -1]
  bool bent = false;   ///< the exponent, or a derivative for it, is not 0
  T friction{0.0};     ///< [1, >= 0]
};

/// Motion of the sole in the frame of the plate.
template <class T>
struct SoleMotion {
  AlongSole<T> depth;    ///< [m]
  AlongSole<T> slip;     ///< velocity towards the toes [m/s]
  AlongSole<T> lifting;  ///< velocity off the plate [m/s]
};

/// Sums over the strips, x from the ankle. Energy and power have no derivatives.
template <class T>
struct SoleForces {
  T normal{0.0};          ///< off the plate [N]
  T normal_moment{0.0};   ///< of normal times x [N m]
  T shear{0.0};           ///< towards the toes [N]
  T shear_moment{0.0};    ///< [N m]
  double stored = 0;      ///< [J]
  double dissipated = 0;  ///< [W]
};

/// Factor of the normal force of Hollars's law with equal static and dynamic friction, over its coefficient.
[[nodiscard]] inline double FrictionRatio(double slip, double transition_velocity) {
  return std::fmin(std::fmax(slip / transition_velocity, -1), 1);
}

namespace sole_bed {

constexpr double kReferenceDepth = 0.005;  // [m] at which the exponent changes nothing

/// Forces of one strip and their slopes. Shear follows normal by `share`.
struct Strip {
  double normal = 0;
  double shear = 0;
  double share = 0;
  double per_depth = 0;  ///< of the normal force, as are the next ones
  double per_lifting = 0;
  double per_dissipation = 0;
  double per_exponent = 0;
  double per_slip = 0;      ///< of the shear force beside that
  double per_friction = 0;  ///< of the shear force beside that
};

/// Derivatives of the four sums, strip by strip. @tparam T double: none
template <class T>
class Derivatives {
 public:
  Derivatives(const SoleLaw<T>& /*law*/, const SoleMotion<T>& /*motion*/) {}
  void Add(const Strip& /*strip*/, double /*x*/) {}
  void AddTo(SoleForces<T>& /*sum*/) const {}
};

/// For one derivative, directly.
template <>
class Derivatives<Dual<1>> {
 public:
  using T = Dual<1>;
  Derivatives(const SoleLaw<T>& law, const SoleMotion<T>& motion) : law_(law), motion_(motion) {}

  void Add(const Strip& strip, double x) {
    const auto along = [&](const AlongSole<T>& of) { return of.at_ankle.d[0] + x * of.per_x.d[0]; };
    double normal = strip.per_depth * along(motion_.depth) + strip.per_lifting * along(motion_.lifting) +
                    strip.normal / law_.stiffness.value * law_.stiffness.d[0] +
                    strip.per_dissipation * law_.dissipation.d[0];
    if (law_.bent) normal += strip.per_exponent * law_.exponent.d[0];
    const double shear =
        strip.share * normal + strip.per_slip * along(motion_.slip) + strip.per_friction * law_.friction.d[0];
    sum_.normal.d[0] += normal;
    sum_.normal_moment.d[0] += normal * x;
    sum_.shear.d[0] += shear;
    sum_.shear_moment.d[0] += shear * x;
  }

  void AddTo(SoleForces<T>& sum) const {
    sum.normal += sum_.normal;
    sum.normal_moment += sum_.normal_moment;
    sum.shear += sum_.shear;
    sum.shear_moment += sum_.shear_moment;
  }

 private:
  const SoleLaw<T>& law_;
  const SoleMotion<T>& motion_;
  SoleForces<T> sum_;
};

/// For many derivatives, by moments of the slopes.
template <int N>
class Derivatives<Dual<N>> {
 public:
  using T = Dual<N>;
  Derivatives(const SoleLaw<T>& law, const SoleMotion<T>& motion) : law_(law), motion_(motion) {}

  void Add(const Strip& strip, double x) {
    normal_.Add(strip, 1, x);
    shear_.Add(strip, strip.share, x);
    slip_.Add(strip.per_slip, x);
    friction_.Add(strip.per_friction, x);
  }

  void AddTo(SoleForces<T>& sum) const {
    Follow(normal_, sum.normal, sum.normal_moment);
    Follow(shear_, sum.shear, sum.shear_moment);
    Follow(slip_, motion_.slip, sum.shear, sum.shear_moment);
    Follow(friction_, law_.friction, sum.shear, sum.shear_moment);
  }

 private:
  // Of a slope, times x^0, x and x^2.
  struct Moments {
    double zeroth = 0;
    double first = 0;
    double second = 0;

    void Add(double slope, double x) {
      zeroth += slope;
      first += slope * x;
      second += slope * x * x;
    }
  };
  struct OfForce {
    Moments value;
    Moments depth;
    Moments lifting;
    Moments dissipation;
    Moments exponent;

    void Add(const Strip& strip, double share, double x) {
      value.Add(share * strip.normal, x);
      depth.Add(share * strip.per_depth, x);
      lifting.Add(share * strip.per_lifting, x);
      dissipation.Add(share * strip.per_dissipation, x);
      exponent.Add(share * strip.per_exponent, x);
    }
  };

  static void Follow(const Moments& slope, const AlongSole<T>& of, T& sum, T& moment) {
#pragma omp simd
    for (int i = 0; i < N; ++i) {
      sum.d[i] += slope.zeroth * of.at_ankle.d[i] + slope.first * of.per_x.d[i];
      moment.d[i] += slope.first * of.at_ankle.d[i] + slope.second * of.per_x.d[i];
    }
  }
  static void Follow(const Moments& slope, const T& of, T& sum, T& moment) {
#pragma omp simd
    for (int i = 0; i < N; ++i) {
      sum.d[i] += slope.zeroth * of.d[i];
      moment.d[i] += slope.first * of.d[i];
    }
  }
  void Follow(const OfForce& force, T& sum, T& moment) const {
    Follow(force.depth, motion_.depth, sum, moment);
    Follow(force.lifting, motion_.lifting, sum, moment);
    const double per_stiffness = 1 / law_.stiffness.value;
    Follow({force.value.zeroth * per_stiffness, force.value.first * per_stiffness, 0}, law_.stiffness, sum,
           moment);
    Follow(force.dissipation, law_.dissipation, sum, moment);
    if (law_.bent) Follow(force.exponent, law_.exponent, sum, moment);
  }

  const SoleLaw<T>& law_;
  const SoleMotion<T>& motion_;
  OfForce normal_;
  OfForce shear_;
  Moments slip_;
  Moments friction_;
};

}  // namespace sole_bed

/// @tparam T double or Dual
template <class T>
[[nodiscard]] SoleForces<T> SumOfStrips(const FootGeometry& foot, const SoleLaw<T>& law,
                                        const SoleMotion<T>& motion) {
  const double width = (foot.heel + foot.toe) / foot.strips;
  const double stiffness = Value(law.stiffness);
  const double dissipation = Value(law.dissipation);
  const double exponent = Value(law.exponent);
  const double friction = Value(law.friction);
  const auto along = [](const AlongSole<T>& of, double x) {
    return Value(of.at_ankle) + x * Value(of.per_x);
  };
  double normal = 0;
  double normal_moment = 0;
  double shear = 0;
  double shear_moment = 0;
  SoleForces<T> sum;
  sole_bed::Derivatives<T> derivatives(law, motion);
  for (int i = 0; i < foot.strips; ++i) {
    const double x = -foot.heel + (i + 0.5) * width;
    const double depth = along(motion.depth, x);
    if (!(depth > 0)) continue;
    const double slip = along(motion.slip, x);
    const double lifting = along(motion.lifting, x);
    const double bend = law.bent ? std::pow(depth / sole_bed::kReferenceDepth, exponent) : 1;
    const double elastic = stiffness * depth * bend;
    sum.stored += elastic * depth / (2 + exponent);
    const double damped = 1 - dissipation * lifting;
    if (!(damped > 0)) {
      sum.dissipated += elastic * lifting;
      continue;
    }
    const double ratio = FrictionRatio(slip, foot.transition_velocity);
    sole_bed::Strip strip;
    strip.normal = elastic * damped;
    strip.share = -friction * ratio;
    strip.shear = strip.share * strip.normal;
    normal += strip.normal;
    normal_moment += strip.normal * x;
    shear += strip.shear;
    shear_moment += strip.shear * x;
    sum.dissipated -= (strip.normal - elastic) * lifting + strip.shear * slip;
    strip.per_depth = stiffness * bend * (1 + exponent) * damped;
    strip.per_lifting = -elastic * dissipation;
    strip.per_dissipation = -elastic * lifting;
    if (law.bent) strip.per_exponent = strip.normal * std::log(depth / sole_bed::kReferenceDepth);
    if (std::abs(ratio) < 1) strip.per_slip = -strip.normal * friction / foot.transition_velocity;
    strip.per_friction = -strip.normal * ratio;
    derivatives.Add(strip, x);
  }
  sum.normal = T(normal);
  sum.normal_moment = T(normal_moment);
  sum.shear = T(shear);
  sum.shear_moment = T(shear_moment);
  derivatives.AddTo(sum);
  return sum;
}

}  // namespace sinew
