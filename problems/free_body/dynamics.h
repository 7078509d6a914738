// Equations of motion of the thrown body, for plain numbers and for dual numbers.
#pragma once

#include <array>
#include <cmath>

#include "base/dual.h"
#include "identify/effect.h"
#include "problems/free_body/free_body.h"

namespace sinew {

/// Mass centre x y z, velocity, orientation w x y z (body to world), angular velocity in body axes.
template <class T>
using BodyState = std::array<T, 13>;
enum BodyStatePlace { kPlace = 0, kVelocity = 3, kQuaternion = 6, kSpin = 10 };

template <class T>
using Triple = std::array<T, 3>;

template <class T>
Triple<T> Cross(const Triple<T>& a, const Triple<T>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <class A, class B>
auto Dot(const Triple<A>& a, const Triple<B>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Rotation matrix of a quaternion that is nearly of unit length, row by row.
template <class T>
std::array<Triple<T>, 3> RotationOf(const T* q) {
  const T s = 2.0 / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  const T xs = q[1] * s;
  const T ys = q[2] * s;
  const T zs = q[3] * s;
  const T wx = q[0] * xs;
  const T wy = q[0] * ys;
  const T wz = q[0] * zs;
  const T xx = q[1] * xs;
  const T xy = q[1] * ys;
  const T xz = q[1] * zs;
  const T yy = q[2] * ys;
  const T yz = q[2] * zs;
  const T zz = q[3] * zs;
  return {Triple<T>{1.0 - (yy + zz), xy - wz, xz + wy}, Triple<T>{xy + wz, 1.0 - (xx + zz), yz - wx},
          Triple<T>{xz - wy, yz + wx, 1.0 - (xx + yy)}};
}

/// a b, Hamilton's product.
template <class A, class B>
auto Product(const A* a, const B* b) -> std::array<decltype(a[0] * b[0]), 4> {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
          a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
          a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

/// Unit quaternion of a small turn [rad]; exact to first order in its derivatives at 0.
template <class T>
std::array<T, 4> SmallTurn(const Triple<T>& turn) {
  const T squared = 0.25 * Dot(turn, turn);
  const T scale = 1.0 / Sqrt(1.0 + squared);
  return {scale, 0.5 * turn[0] * scale, 0.5 * turn[1] * scale, 0.5 * turn[2] * scale};
}

template <class T, class A>
Triple<T> Times(const std::array<Triple<T>, 3>& rotation, const Triple<A>& a) {
  return {Dot(rotation[0], a), Dot(rotation[1], a), Dot(rotation[2], a)};
}

/// @tparam T of the state: double or Dual @tparam P of the parameters: T, or double where nothing is
/// differentiated for them, which halves the work
template <class T, class P = T>
class FreeBodyDynamics {
 public:
  /// @param variables [kFreeBodySlots] @param used which of them are not at rest, or are differentiated
  FreeBodyDynamics(const FreeBody& body, const std::array<P, kFreeBodySlots>& variables,
                   const std::array<bool, kFreeBodySlots>& used)
      : body_(body), p_(variables), used_(used) {
    const P length =
        1.0 / Sqrt(1.0 + p_[kTableSlopeX] * p_[kTableSlopeX] + p_[kTableSlopeY] * p_[kTableSlopeY]);
    normal_ = {-p_[kTableSlopeX] * length, -p_[kTableSlopeY] * length, length};
    height_ = p_[kTableHeight] * length;
    for (int i = 0; i < 3; ++i) inertia_[i] = body.inertia[i] * (1.0 + p_[kInertiaShare]);
    const P g = body.gravity * (1.0 + p_[kGravityShare]);
    gravity_ = {g * p_[kGravityTiltX], g * p_[kGravityTiltY], -g};
    exponent_ = p_[kExponent];
    slips_ = Any(kSlipTerm);
    approaches_ = Any(kApproachTerm);
  }

  /// @param fastest if not null: a bound of the rate at which contact changes the state [1/s]. A body that
  /// is at rest does not show its stiffness to the error control, but its derivatives would grow in steps
  /// that are too long.
  void Derivative(const BodyState<T>& state, BodyState<T>& rate, double* fastest = nullptr) const {
    Stiffness stiffness;
    const auto rotation = RotationOf(&state[kQuaternion]);
    const Triple<T> velocity{state[kVelocity], state[kVelocity + 1], state[kVelocity + 2]};
    const Triple<T> spin{state[kSpin], state[kSpin + 1], state[kSpin + 2]};
    Triple<T> force{T(0), T(0), T(0)};
    Triple<T> torque{T(0), T(0), T(0)};  // about the mass centre, world axes
    AddContact(state, rotation, velocity, spin, force, torque, stiffness);
    if (fastest != nullptr) *fastest = stiffness.damping + std::sqrt(stiffness.spring);
    const double per_mass = 1 / body_.mass;
    for (int i = 0; i < 3; ++i) {
      rate[kPlace + i] = velocity[i];
      rate[kVelocity + i] = gravity_[i] + per_mass * force[i];
    }
    if (used_[kAirDrag]) {
      const T drag = p_[kAirDrag] * Sqrt(Dot(velocity, velocity) + 1e-12);
      for (int i = 0; i < 3; ++i) rate[kVelocity + i] -= drag * velocity[i];
    }
    const T* q = &state[kQuaternion];
    rate[kQuaternion] = -0.5 * (q[1] * spin[0] + q[2] * spin[1] + q[3] * spin[2]);
    rate[kQuaternion + 1] = 0.5 * (q[0] * spin[0] + q[2] * spin[2] - q[3] * spin[1]);
    rate[kQuaternion + 2] = 0.5 * (q[0] * spin[1] - q[1] * spin[2] + q[3] * spin[0]);
    rate[kQuaternion + 3] = 0.5 * (q[0] * spin[2] + q[1] * spin[1] - q[2] * spin[0]);
    const Triple<T> momentum{inertia_[0] * spin[0], inertia_[1] * spin[1], inertia_[2] * spin[2]};
    const Triple<T> gyroscopic = Cross(spin, momentum);
    for (int i = 0; i < 3; ++i) {
      const T own = rotation[0][i] * torque[0] + rotation[1][i] * torque[1] + rotation[2][i] * torque[2];
      rate[kSpin + i] = (own - gyroscopic[i]) / inertia_[i];
    }
  }

  [[nodiscard]] const FreeBody& body() const { return body_; }
  [[nodiscard]] const P& operator[](int slot) const { return p_[static_cast<std::size_t>(slot)]; }
  [[nodiscard]] bool uses(int slot) const { return used_[static_cast<std::size_t>(slot)]; }

 private:
  struct Stiffness {
    double damping = 0;  // [1/s]
    double spring = 0;   // [1/s2]
  };

  [[nodiscard]] bool Any(int first) const {
    for (int i = first; i < first + kFreeBodyKnots; ++i) {
      if (used_[static_cast<std::size_t>(i)]) return true;
    }
    return false;
  }

  [[nodiscard]] T HatTerm(int first, const std::vector<double>& knots, const T& x) const {
    const LinearBasis basis = LinearBasisAt(knots, Value(x));
    const auto at = static_cast<std::size_t>(first + basis.first);
    if (basis.right == 0 && basis.left_slope == 0) return p_[at] * basis.left;
    const T right = basis.right - basis.left_slope * (x - Value(x));
    return p_[at] * (1.0 - right) + p_[at + 1] * right;
  }

  void AddContact(const BodyState<T>& state, const std::array<Triple<T>, 3>& rotation,
                  const Triple<T>& velocity, const Triple<T>& spin, Triple<T>& force, Triple<T>& torque,
                  Stiffness& stiffness) const {
    // Most of the time nothing touches: decided on plain numbers.
    const double nz = Value(normal_[2]);
    const Vec3 up(Value(normal_[0]), Value(normal_[1]), nz);
    const double middle =
        up[0] * Value(state[0]) + up[1] * Value(state[1]) + up[2] * Value(state[2]) - Value(height_);
    const double grown = 1 + Value(p_[kSizeError]);
    const double offset =
        Vec3(Value(p_[kMassCentreX]), Value(p_[kMassCentreY]), Value(p_[kMassCentreZ])).norm();
    if (middle > body_.reach * grown + offset) return;
    Vec3 down;
    for (int j = 0; j < 3; ++j)
      down[j] = up[0] * Value(rotation[0][j]) + up[1] * Value(rotation[1][j]) + up[2] * Value(rotation[2][j]);
    const double radius = Value(p_[kCornerRadius]);
    const Vec3 centre(Value(p_[kMassCentreX]), Value(p_[kMassCentreY]), Value(p_[kMassCentreZ]));
    Triple<T> world_spin;
    bool any = false;
    for (const ContactPoint& point : body_.points) {
      const Vec3 arm = grown * point.place + radius * point.inward - centre;
      if (middle + down.dot(arm) - (point.inward.isZero() ? 0 : radius) >= 0) continue;
      if (!any) world_spin = Times(rotation, spin);
      any = true;
      AddPoint(point, state, rotation, velocity, world_spin, force, torque, stiffness);
    }
  }

  void AddPoint(const ContactPoint& point, const BodyState<T>& state,
                const std::array<Triple<T>, 3>& rotation, const Triple<T>& velocity,
                const Triple<T>& world_spin, Triple<T>& force, Triple<T>& torque,
                Stiffness& stiffness) const {
    Triple<P> arm;
    for (int i = 0; i < 3; ++i) {
      arm[i] = point.place[i] * (1.0 + p_[kSizeError]) + point.inward[i] * p_[kCornerRadius] -
               p_[kMassCentreX + i];
    }
    Triple<T> lever = Times(rotation, arm);
    if (used_[kCornerRadius] && !point.inward.isZero()) {
      for (int i = 0; i < 3; ++i) lever[i] -= p_[kCornerRadius] * normal_[i];
    }
    const Triple<T> place{state[0] + lever[0], state[1] + lever[1], state[2] + lever[2]};
    const T depth = height_ - Dot(normal_, place);
    if (!(Value(depth) > 0)) return;
    Triple<T> speed = Cross(world_spin, lever);
    for (int i = 0; i < 3; ++i) speed[i] += velocity[i];
    const T rate = -Dot(normal_, speed);
    const T pressing = Normal(point.weight, depth, rate);
    if (!(Value(pressing) > 0)) return;
    Triple<T> slip;
    for (int i = 0; i < 3; ++i) slip[i] = speed[i] + rate * normal_[i];
    const T held = pressing * FrictionPerSlip(Sqrt(Dot(slip, slip) + kRestingSlip * kRestingSlip));
    const double arm_squared = Value(Dot(lever, lever));
    const double mobility = 1 / body_.mass + arm_squared / body_.inertia.minCoeff();
    stiffness.damping += mobility * (Value(held) + 1.5 * Value(p_[kDissipation]) * Value(pressing));
    stiffness.spring += mobility * 1.5 * Value(pressing) / Value(depth);
    Triple<T> push;
    for (int i = 0; i < 3; ++i) {
      push[i] = pressing * normal_[i] - held * slip[i];
      force[i] += push[i];
    }
    const Triple<T> turn = Cross(lever, push);
    for (int i = 0; i < 3; ++i) torque[i] += turn[i];
  }

  [[nodiscard]] T Normal(double weight, const T& depth, const T& rate) const {
    const bool vertices = body_.contact == FreeBodyContact::kVertices;
    T spring = vertices ? depth * Sqrt(depth) : depth;
    spring = (weight * p_[kStiffness]) * spring;
    if (used_[kExponent]) spring = spring * Exp(exponent_ * Log(depth * (1 / kExponentDepth)));
    T damping = 1.0 + (vertices ? 1.5 : 1.0) * p_[kDissipation] * rate;
    if (used_[kReboundLoss]) {
      const double x = std::tanh(Value(rate) / kReboundSpeed);
      const T unloading = 0.5 - 0.5 * (x + (1 - x * x) / kReboundSpeed * (rate - Value(rate)));
      damping = damping * (1.0 - p_[kReboundLoss] * unloading);
    }
    if (approaches_) damping += HatTerm(kApproachTerm, body_.knots[1], rate);
    return spring * damping;
  }

  [[nodiscard]] T FrictionPerSlip(const T& slip) const {
    const double vt = body_.transition_velocity;
    T level = p_[kFriction];
    if (used_[kStaticExcess]) {
      const T ratio = slip * (1 / vt);
      level = level + 2.0 * p_[kStaticExcess] / (1.0 + ratio * ratio);
    }
    if (slips_) level = level + HatTerm(kSlipTerm, body_.knots[0], slip);
    T per_slip = Value(slip) < vt ? level * (1 / vt) : level / slip;
    if (used_[kViscousSlip]) per_slip += p_[kViscousSlip];
    return per_slip;
  }

  static constexpr double kRestingSlip = 1e-7;    // [m/s] below it there is no direction of slip
  static constexpr double kExponentDepth = 1e-3;  // [m] where another exponent changes nothing
  static constexpr double kReboundSpeed = 0.02;   // [m/s] over which loading turns to unloading

  const FreeBody& body_;
  const std::array<P, kFreeBodySlots>& p_;
  const std::array<bool, kFreeBodySlots>& used_;
  Triple<P> normal_;
  P height_;
  Triple<P> inertia_;
  Triple<P> gravity_;
  P exponent_;
  bool slips_ = false;
  bool approaches_ = false;
};

}  // namespace sinew
