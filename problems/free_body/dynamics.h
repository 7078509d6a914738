// Equations of motion of the thrown body, with derivatives.
#pragma once

#include <array>
#include <cmath>
#include <type_traits>

#include "base/dual.h"
#include "base/linear_algebra.h"
#include "base/linear_basis.h"
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

/// Derivatives of a number for L lanes.
template <int L>
using Lanes = Eigen::Array<double, L, 1>;

/// A state or its rate, and the derivatives of each of its numbers. These are carried beside the values by
/// the chain rule written out, which takes a quarter of the operations of dual numbers throughout: a turn has
/// three directions, not the nine numbers of a matrix, and a force follows from one depth and one velocity.
template <int L>
struct Motion {
  BodyState<double> value;
  std::array<Lanes<L>, 13> slope;
};
template <>
struct Motion<0> {
  BodyState<double> value;
};

template <class T>
constexpr int kLanesOf = 0;
template <int N>
constexpr int kLanesOf<Dual<N>> = N;

/// @tparam L number of lanes, 0 for values alone; values are the same with and without
/// @tparam P of the parameters: Dual<L>, or double where nothing is differentiated for them
template <int L, class P>
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
    for (std::size_t i = 0; i < 3; ++i) {
      up_[i] = Value(normal_[i]);
      inertia_[i] = body.inertia[static_cast<Eigen::Index>(i)] * (1.0 + Value(p_[kInertiaShare]));
    }
    tumbles_ = body.inertia.minCoeff() < body.inertia.maxCoeff();
    const P g = body.gravity * (1.0 + p_[kGravityShare]);
    gravity_ = {g * p_[kGravityTiltX], g * p_[kGravityTiltY], -g};
    slips_ = Any(kSlipTerm);
    approaches_ = Any(kApproachTerm);
    for (std::size_t i = 0; i < p_.size(); ++i) law_[i] = OfLaw(p_[i]);
    if constexpr (kParameters) {
      const auto moves = [&](int slot) {
        return Slope(p_[static_cast<std::size_t>(slot)]).abs().maxCoeff() > 0;
      };
      for (const int slot : {kSizeError, kCornerRadius, kMassCentreX, kMassCentreY, kMassCentreZ})
        points_move_ = points_move_ || moves(slot);
      for (const int slot : {kTableHeight, kTableSlopeX, kTableSlopeY})
        table_moves_ = table_moves_ || moves(slot);
      inertia_changes_ = moves(kInertiaShare);
    }
  }

  /// @param fastest if not null: a bound of the rate at which contact changes the state [1/s]. A body that
  /// is at rest does not show its stiffness to the error control, but its derivatives would grow in steps
  /// that are too long.
  void Derivative(const Motion<L>& state, Motion<L>& rate, double* fastest = nullptr) const {
    const BodyState<double>& x = state.value;
    BodyState<double>& dx = rate.value;
    Place at;
    at.rotation = RotationOf(&x[kQuaternion]);
    at.velocity = {x[kVelocity], x[kVelocity + 1], x[kVelocity + 2]};
    const Triple<double> spin{x[kSpin], x[kSpin + 1], x[kSpin + 2]};
    Load load;
    AddContact(state, at, spin, load);
    if (fastest != nullptr) *fastest = load.damping + std::sqrt(load.spring);
    const double per_mass = 1 / body_.mass;
    for (std::size_t i = 0; i < 3; ++i) {
      dx[kPlace + i] = at.velocity[i];
      dx[kVelocity + i] = Value(gravity_[i]) + per_mass * load.force[i];
      if constexpr (L > 0) {
        rate.slope[kPlace + i] = state.slope[kVelocity + i];
        if (load.any) {
          rate.slope[kVelocity + i] = per_mass * load.force_slope[i];
        } else {
          rate.slope[kVelocity + i].setZero();
        }
        AddSlope(1, gravity_[i], rate.slope[kVelocity + i]);
      }
    }
    if (used_[kAirDrag]) AddDrag(state, at.velocity, rate);
    const double* q = &x[kQuaternion];
    dx[kQuaternion] = -0.5 * (q[1] * spin[0] + q[2] * spin[1] + q[3] * spin[2]);
    dx[kQuaternion + 1] = 0.5 * (q[0] * spin[0] + q[2] * spin[2] - q[3] * spin[1]);
    dx[kQuaternion + 2] = 0.5 * (q[0] * spin[1] - q[1] * spin[2] + q[3] * spin[0]);
    dx[kQuaternion + 3] = 0.5 * (q[0] * spin[2] + q[1] * spin[1] - q[2] * spin[0]);
    const Triple<double> momentum{inertia_[0] * spin[0], inertia_[1] * spin[1], inertia_[2] * spin[2]};
    const Triple<double> gyroscopic = Cross(spin, momentum);
    for (std::size_t i = 0; i < 3; ++i) {
      const double own = at.rotation[0][i] * load.torque[0] + at.rotation[1][i] * load.torque[1] +
                         at.rotation[2][i] * load.torque[2];
      dx[kSpin + i] = (own - gyroscopic[i]) / inertia_[i];
    }
    if constexpr (L > 0) AddTurning(state, at, spin, load, rate);
  }

  [[nodiscard]] const FreeBody& body() const { return body_; }

 private:
  static constexpr bool kParameters = !std::is_same_v<P, double>;
  // Of the contact's law: depth, depth rate and slip speed, then the lanes.
  static constexpr int kDepthLane = 0;
  static constexpr int kRateLane = 1;
  static constexpr int kSlipLane = 2;
  static constexpr int kLawLanes = 3;
  using LawParameter = std::conditional_t<kParameters, Dual<kLawLanes + (kParameters ? L : 0)>, double>;
  using LawNumber = std::conditional_t<L == 0, double, Dual<kLawLanes + (kParameters ? L : 0)>>;
  static constexpr int kSlopes = L > 0 ? L : 1;
  using Slopes = Lanes<kSlopes>;

  // Where the body is, and what its points' places and velocities follow from.
  struct Place {
    std::array<Triple<double>, 3> rotation;
    Triple<double> velocity;
    Triple<double> world_spin;
    Triple<Slopes> turn;  // of the body [rad, world axes]
    Triple<Slopes> world_spin_slope;
  };
  // On the body by the table; torque about the mass centre, world axes.
  struct Load {
    bool any = false;
    Triple<double> force{0, 0, 0};
    Triple<double> torque{0, 0, 0};
    Triple<Slopes> force_slope;
    Triple<Slopes> torque_slope;
    double damping = 0;  // [1/s]
    double spring = 0;   // [1/s2]
  };

  [[nodiscard]] bool Any(int first) const {
    for (int i = first; i < first + kFreeBodyKnots; ++i) {
      if (used_[static_cast<std::size_t>(i)]) return true;
    }
    return false;
  }

  static auto Slope(const P& p) { return Eigen::Map<const Lanes<L>, Eigen::Unaligned>(p.d.data()); }
  static void AddSlope(double factor, const P& p, Slopes& to) {
    if constexpr (kParameters) to += factor * Slope(p);
  }

  static LawParameter OfLaw(const P& p) {
    if constexpr (kParameters) {
      LawParameter x(p.value);
      std::copy(p.d.begin(), p.d.end(), x.d.begin() + kLawLanes);
      return x;
    } else {
      return p;
    }
  }
  static LawNumber LawVariable(double x, int lane) {
    if constexpr (L > 0) {
      return LawNumber::Variable(x, lane);
    } else {
      return x;
    }
  }
  // What the law's number changes by for the lanes, but for the slip's part.
  static Slopes LawSlope(const LawNumber& x, const Slopes& depth, const Slopes& rate) {
    Slopes slope = x.d[kDepthLane] * depth + x.d[kRateLane] * rate;
    if constexpr (kParameters) slope += Eigen::Map<const Slopes, Eigen::Unaligned>(x.d.data() + kLawLanes);
    return slope;
  }

  void AddDrag(const Motion<L>& state, const Triple<double>& velocity, Motion<L>& rate) const {
    const double size = Sqrt(Dot(velocity, velocity) + 1e-12);
    const double share = Value(p_[kAirDrag]);
    const double drag = share * size;
    for (std::size_t i = 0; i < 3; ++i) rate.value[kVelocity + i] -= drag * velocity[i];
    if constexpr (L > 0) {
      Slopes drag_slope =
          (share / size) * (velocity[0] * state.slope[kVelocity] + velocity[1] * state.slope[kVelocity + 1] +
                            velocity[2] * state.slope[kVelocity + 2]);
      AddSlope(size, p_[kAirDrag], drag_slope);
      for (std::size_t i = 0; i < 3; ++i)
        rate.slope[kVelocity + i] -= drag * state.slope[kVelocity + i] + velocity[i] * drag_slope;
    }
  }

  // Of the quaternion's rate and of the angular acceleration, whose values are known.
  void AddTurning(const Motion<L>& state, const Place& at, const Triple<double>& spin, const Load& load,
                  Motion<L>& rate) const {
    const double* q = &state.value[kQuaternion];
    const Slopes* dq = &state.slope[kQuaternion];
    const Slopes* dw = &state.slope[kSpin];
    const Triple<double> half{0.5 * spin[0], 0.5 * spin[1], 0.5 * spin[2]};
    const double h[4] = {0.5 * q[0], 0.5 * q[1], 0.5 * q[2], 0.5 * q[3]};
    Slopes* to = &rate.slope[kQuaternion];
    to[0] =
        -(half[0] * dq[1] + half[1] * dq[2] + half[2] * dq[3] + h[1] * dw[0] + h[2] * dw[1] + h[3] * dw[2]);
    to[1] = half[0] * dq[0] + half[2] * dq[2] - half[1] * dq[3] + h[0] * dw[0] + h[2] * dw[2] - h[3] * dw[1];
    to[2] = half[1] * dq[0] - half[2] * dq[1] + half[0] * dq[3] + h[0] * dw[1] - h[1] * dw[2] + h[3] * dw[0];
    to[3] = half[2] * dq[0] + half[1] * dq[1] - half[0] * dq[2] + h[0] * dw[2] + h[1] * dw[1] - h[2] * dw[0];
    Triple<Slopes> world;
    if (load.any) {
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        const std::size_t k = (i + 2) % 3;
        world[i] = load.torque_slope[i] - load.torque[k] * at.turn[j] + load.torque[j] * at.turn[k];
      }
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3;
      const std::size_t k = (i + 2) % 3;
      Slopes& slope = rate.slope[kSpin + i];
      if (load.any) {
        slope = (1 / inertia_[i]) *
                (at.rotation[0][i] * world[0] + at.rotation[1][i] * world[1] + at.rotation[2][i] * world[2]);
      } else {
        slope.setZero();
      }
      if (tumbles_) {
        const double unequal = (inertia_[k] - inertia_[j]) / inertia_[i];
        slope -= (unequal * spin[k]) * dw[j] + (unequal * spin[j]) * dw[k];
      }
      // Moments of inertia change by one factor, which leaves the gyroscopic part of the acceleration.
      if constexpr (kParameters) {
        if (inertia_changes_ && load.any) {
          const double own = at.rotation[0][i] * load.torque[0] + at.rotation[1][i] * load.torque[1] +
                             at.rotation[2][i] * load.torque[2];
          AddSlope(-own / inertia_[i] / (1 + Value(p_[kInertiaShare])), p_[kInertiaShare], slope);
        }
      }
    }
  }

  // d turn, from the quaternion's derivatives: twice the vector part of dq times its conjugate.
  static void FindTurn(const Motion<L>& state, Place& at) {
    const double* q = &state.value[kQuaternion];
    const Slopes* d = &state.slope[kQuaternion];
    const double s = 2.0 / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    const double a[4] = {s * q[0], s * q[1], s * q[2], s * q[3]};
    at.turn[0] = a[0] * d[1] - a[1] * d[0] - a[3] * d[2] + a[2] * d[3];
    at.turn[1] = a[0] * d[2] - a[2] * d[0] - a[1] * d[3] + a[3] * d[1];
    at.turn[2] = a[0] * d[3] - a[3] * d[0] - a[2] * d[1] + a[1] * d[2];
  }

  void AddContact(const Motion<L>& state, Place& at, const Triple<double>& spin, Load& load) const {
    // Most of the time nothing touches.
    const BodyState<double>& x = state.value;
    const double middle = up_[0] * x[0] + up_[1] * x[1] + up_[2] * x[2] - Value(height_);
    const double grown = 1 + Value(p_[kSizeError]);
    const Vec3 centre(Value(p_[kMassCentreX]), Value(p_[kMassCentreY]), Value(p_[kMassCentreZ]));
    if (middle > body_.reach * grown + centre.norm()) return;
    Vec3 down;
    for (std::size_t j = 0; j < 3; ++j)
      down[static_cast<Eigen::Index>(j)] =
          up_[0] * at.rotation[0][j] + up_[1] * at.rotation[1][j] + up_[2] * at.rotation[2][j];
    const double radius = Value(p_[kCornerRadius]);
    bool known = false;
    for (const ContactPoint& point : body_.points) {
      const Vec3 arm = grown * point.place + radius * point.inward - centre;
      if (middle + down.dot(arm) - (point.inward.isZero() ? 0 : radius) >= 0) continue;
      if (!known) at.world_spin = Times(at.rotation, spin);
      if constexpr (L > 0) {
        if (!known) {
          FindTurn(state, at);
          for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t j = (i + 1) % 3;
            const std::size_t k = (i + 2) % 3;
            at.world_spin_slope[i] = at.world_spin[k] * at.turn[j] - at.world_spin[j] * at.turn[k] +
                                     at.rotation[i][0] * state.slope[kSpin] +
                                     at.rotation[i][1] * state.slope[kSpin + 1] +
                                     at.rotation[i][2] * state.slope[kSpin + 2];
          }
        }
      }
      known = true;
      AddPoint(point, state, at, load);
    }
  }

  void AddPoint(const ContactPoint& point, const Motion<L>& state, const Place& at, Load& load) const {
    const BodyState<double>& x = state.value;
    const bool ball = used_[kCornerRadius] && !point.inward.isZero();
    const double grown = 1.0 + Value(p_[kSizeError]);
    Triple<double> arm;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      arm[i] =
          point.place[k] * grown + point.inward[k] * Value(p_[kCornerRadius]) - Value(p_[kMassCentreX + i]);
    }
    const Triple<double> turned = Times(at.rotation, arm);
    Triple<double> lever = turned;
    if (ball) {
      for (std::size_t i = 0; i < 3; ++i) lever[i] -= Value(p_[kCornerRadius]) * up_[i];
    }
    const Triple<double> place{x[0] + lever[0], x[1] + lever[1], x[2] + lever[2]};
    const double depth = Value(height_) - Dot(up_, place);
    if (!(depth > 0)) return;
    Triple<double> speed = Cross(at.world_spin, lever);
    for (std::size_t i = 0; i < 3; ++i) speed[i] += at.velocity[i];
    const double rate = -Dot(up_, speed);
    const LawNumber pressing =
        Normal(point.weight, LawVariable(depth, kDepthLane), LawVariable(rate, kRateLane));
    const double n = Value(pressing);
    if (!(n > 0)) return;
    Triple<double> slip;
    for (std::size_t i = 0; i < 3; ++i) slip[i] = speed[i] + rate * up_[i];
    const double slipping = std::sqrt(Dot(slip, slip) + kRestingSlip * kRestingSlip);
    const LawNumber held = pressing * FrictionPerSlip(LawVariable(slipping, kSlipLane));
    const double h = Value(held);
    const double mobility = 1 / body_.mass + Dot(lever, lever) / body_.inertia.minCoeff();
    load.damping += mobility * (h + 1.5 * Value(p_[kDissipation]) * n);
    load.spring += mobility * 1.5 * n / depth;
    Triple<double> push;
    for (std::size_t i = 0; i < 3; ++i) {
      push[i] = n * up_[i] - h * slip[i];
      load.force[i] += push[i];
    }
    const Triple<double> turn = Cross(lever, push);
    for (std::size_t i = 0; i < 3; ++i) load.torque[i] += turn[i];
    if constexpr (L > 0) {
      Triple<Slopes> lever_slope;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        const std::size_t k = (i + 2) % 3;
        lever_slope[i] = turned[k] * at.turn[j] - turned[j] * at.turn[k];
      }
      if constexpr (kParameters) AddMove(point, at, ball, lever_slope);
      Triple<Slopes> speed_slope;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        const std::size_t k = (i + 2) % 3;
        speed_slope[i] = state.slope[kVelocity + i] + lever[k] * at.world_spin_slope[j] -
                         lever[j] * at.world_spin_slope[k] + at.world_spin[j] * lever_slope[k] -
                         at.world_spin[k] * lever_slope[j];
      }
      Slopes depth_slope =
          -(up_[0] * (state.slope[0] + lever_slope[0]) + up_[1] * (state.slope[1] + lever_slope[1]) +
            up_[2] * (state.slope[2] + lever_slope[2]));
      Slopes rate_slope = -(up_[0] * speed_slope[0] + up_[1] * speed_slope[1] + up_[2] * speed_slope[2]);
      if (table_moves_) {
        AddSlope(1, height_, depth_slope);
        for (std::size_t i = 0; i < 3; ++i) {
          AddSlope(-place[i], normal_[i], depth_slope);
          AddSlope(-speed[i], normal_[i], rate_slope);
        }
      }
      Triple<Slopes> slip_slope;
      for (std::size_t i = 0; i < 3; ++i) {
        slip_slope[i] = speed_slope[i] + up_[i] * rate_slope;
        if (table_moves_) AddSlope(rate, normal_[i], slip_slope[i]);
      }
      const Slopes n_slope = LawSlope(pressing, depth_slope, rate_slope);
      const double by_slip = held.d[kSlipLane] / slipping;
      const Slopes h_slope =
          LawSlope(held, depth_slope, rate_slope) +
          by_slip * (slip[0] * slip_slope[0] + slip[1] * slip_slope[1] + slip[2] * slip_slope[2]);
      Triple<Slopes> push_slope;
      for (std::size_t i = 0; i < 3; ++i) {
        push_slope[i] = up_[i] * n_slope - slip[i] * h_slope - h * slip_slope[i];
        if (table_moves_) AddSlope(n, normal_[i], push_slope[i]);
      }
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        const std::size_t k = (i + 2) % 3;
        const auto torque_slope = push[k] * lever_slope[j] - push[j] * lever_slope[k] +
                                  lever[j] * push_slope[k] - lever[k] * push_slope[j];
        if (load.any) {
          load.force_slope[i] += push_slope[i];
          load.torque_slope[i] += torque_slope;
        } else {
          load.force_slope[i] = push_slope[i];
          load.torque_slope[i] = torque_slope;
        }
      }
    }
    load.any = true;
  }

  // By which a point moves on the body.
  void AddMove(const ContactPoint& point, const Place& at, bool ball, Triple<Slopes>& lever_slope) const {
    if (points_move_) {
      Triple<Slopes> arm_slope;
      for (std::size_t i = 0; i < 3; ++i) {
        const auto k = static_cast<Eigen::Index>(i);
        arm_slope[i].setZero();
        AddSlope(point.place[k], p_[kSizeError], arm_slope[i]);
        AddSlope(point.inward[k], p_[kCornerRadius], arm_slope[i]);
        AddSlope(-1, p_[kMassCentreX + i], arm_slope[i]);
      }
      for (std::size_t i = 0; i < 3; ++i)
        lever_slope[i] += at.rotation[i][0] * arm_slope[0] + at.rotation[i][1] * arm_slope[1] +
                          at.rotation[i][2] * arm_slope[2];
    }
    if (!ball) return;
    for (std::size_t i = 0; i < 3; ++i) {
      AddSlope(-up_[i], p_[kCornerRadius], lever_slope[i]);
      AddSlope(-Value(p_[kCornerRadius]), normal_[i], lever_slope[i]);
    }
  }

  [[nodiscard]] LawNumber HatTerm(int first, const std::vector<double>& knots, const LawNumber& x) const {
    const LinearBasis basis = LinearBasisAt(knots, Value(x));
    const auto at = static_cast<std::size_t>(first + basis.first);
    if (basis.right == 0 && basis.left_slope == 0) return law_[at] * basis.left;
    const LawNumber right = basis.right - basis.left_slope * (x - Value(x));
    return law_[at] * (1.0 - right) + law_[at + 1] * right;
  }

  [[nodiscard]] LawNumber Normal(double weight, const LawNumber& depth, const LawNumber& rate) const {
    const bool vertices = body_.contact == FreeBodyContact::kVertices;
    LawNumber spring = vertices ? depth * Sqrt(depth) : depth;
    spring = (weight * law_[kStiffness]) * spring;
    if (used_[kExponent]) spring = spring * Exp(law_[kExponent] * Log(depth * (1 / kExponentDepth)));
    LawNumber damping = 1.0 + (vertices ? 1.5 : 1.0) * law_[kDissipation] * rate;
    if (used_[kReboundLoss]) {
      const double x = std::tanh(Value(rate) / kReboundSpeed);
      const LawNumber unloading = 0.5 - 0.5 * (x + (1 - x * x) / kReboundSpeed * (rate - Value(rate)));
      damping = damping * (1.0 - law_[kReboundLoss] * unloading);
    }
    if (approaches_) damping += HatTerm(kApproachTerm, body_.knots[1], rate);
    return spring * damping;
  }

  [[nodiscard]] LawNumber FrictionPerSlip(const LawNumber& slip) const {
    const double vt = body_.transition_velocity;
    LawNumber level = law_[kFriction];
    if (used_[kStaticExcess]) {
      const LawNumber ratio = slip * (1 / vt);
      level = level + 2.0 * law_[kStaticExcess] / (1.0 + ratio * ratio);
    }
    if (slips_) level = level + HatTerm(kSlipTerm, body_.knots[0], slip);
    LawNumber per_slip = Value(slip) < vt ? level * (1 / vt) : level / slip;
    if (used_[kViscousSlip]) per_slip += law_[kViscousSlip];
    return per_slip;
  }

  static constexpr double kRestingSlip = 1e-7;    // [m/s] below it there is no direction of slip
  static constexpr double kExponentDepth = 1e-3;  // [m] where another exponent changes nothing
  static constexpr double kReboundSpeed = 0.02;   // [m/s] over which loading turns to unloading

  const FreeBody& body_;
  const std::array<P, kFreeBodySlots>& p_;
  const std::array<bool, kFreeBodySlots>& used_;
  std::array<LawParameter, kFreeBodySlots> law_;
  Triple<P> normal_;
  Triple<double> up_;  // its values
  P height_;
  Triple<double> inertia_;
  Triple<P> gravity_;
  bool tumbles_ = false;  // moments of inertia differ
  bool slips_ = false;
  bool approaches_ = false;
  bool points_move_ = false;
  bool table_moves_ = false;
  bool inertia_changes_ = false;
};

}  // namespace sinew
