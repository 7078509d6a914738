// Horizontal shear of a sole: rubber, skin and heel pad give way under friction, so that what slides over the
// floor lags behind the foot.
//
// With F(t) the horizontal force of all springs (x, z) and C the compliance, the sole is displaced against
// the foot by C F, and its springs slide with
//
//   slip = slip of the foot + w,   w = C dF/dt
//
// where F is the force on the foot: it points against the slip, so that a sole that is being loaded slides
// less than the foot moves. F at an instant thus depends on the instants before it. Their difference is that
// of Gear (1971, Numerical initial value problems) of second order, with steps of any length:
// implicit, since a foot that sticks is a stiff equation.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "base/linear_algebra.h"

namespace sinew {

/// Along x and z.
using Horizontal = Eigen::Vector2d;
using HorizontalJacobian = Eigen::Matrix2d;

[[nodiscard]] inline HorizontalJacobian Inverse(const HorizontalJacobian& m) {
  HorizontalJacobian adjugate;
  adjugate << m(1, 1), -m(0, 1), -m(1, 0), m(0, 0);
  return adjugate / (m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0));
}

/// Of a symmetric matrix (of another, of its symmetric part): the least, and the largest magnitude.
[[nodiscard]] inline std::array<double, 2> Curvatures(const HorizontalJacobian& m) {
  const double mean = 0.5 * (m(0, 0) + m(1, 1));
  const double apart = std::hypot(0.5 * (m(0, 0) - m(1, 1)), 0.5 * (m(0, 1) + m(1, 0)));
  return {mean - apart, std::abs(mean) + apart};
}

/// One stance at one point, instant after instant; its memory, and that of the derivatives.
class SoleShear {
 public:
  /// @param columns of the derivatives
  explicit SoleShear(Eigen::Index columns = 0) : slope_(Matrix2X::Zero(2, columns)) { before_.fill(slope_); }

  /// Before the first instant. @param compliance C [m/N, >= 0]
  void Begin(double compliance);
  /// @param time of the next instant [s]
  void Next(double time);

  /// dF/dt if the force is this now [N/s].
  [[nodiscard]] Horizontal ForceRate(const Horizontal& force) const { return now_ * force - Past(); }

  /// At one velocity of the springs against the foot.
  struct Friction {
    Horizontal force;            ///< on the foot [N]
    HorizontalJacobian by_slip;  ///< its derivative for that velocity
    double potential = 0;        ///< of which the force is minus the gradient [N m/s]
  };
  /// The velocity w of the springs against the foot that this instant's force brings about [m/s]: a minimum
  /// of
  ///
  ///   |w|^2 / 2 + C (now P(w) + past . w)
  ///
  /// with the potential P of friction. There are several where friction falls with the slip: taken is the one
  /// to which Newton's steps lead from the instant before, damped where they are not downhill (Levenberg,
  /// Marquardt).
  /// @param evaluate w -> Friction
  /// @return false: not found within 300 steps
  template <class Evaluate>
  [[nodiscard]] bool Solve(const Evaluate& evaluate, Horizontal& velocity) const;

  /// Of this instant; the derivatives of Slope follow. @param by_slip of the force, for the slip
  void Accept(const Horizontal& velocity, const Horizontal& force, const HorizontalJacobian& by_slip);

  /// Derivative of w for a parameter by way of the force. (That of the compliance has dF/dt besides.) Every
  /// column once per instant.
  /// @param by_parameter derivative of the force at a fixed w (for the compliance: at a fixed dF/dt)
  Horizontal Slope(Eigen::Index column, const Horizontal& by_parameter);

  [[nodiscard]] double compliance() const { return compliance_; }

 private:
  using Matrix2X = Eigen::Matrix<double, 2, Eigen::Dynamic>;
  [[nodiscard]] Horizontal Past() const { return once_ * force_[0] - twice_ * force_[1]; }

  double compliance_ = 0;
  int instants_ = 0;
  double time_ = 0;
  double step_ = 0;
  double now_ = 0;  // weights of the difference: of this instant, the one before, and the one before that
  double once_ = 0;
  double twice_ = 0;
  Horizontal velocity_ = Horizontal::Zero();
  std::array<Horizontal, 2> force_{Horizontal::Zero(), Horizontal::Zero()};  // of the two instants before
  Horizontal accepted_ = Horizontal::Zero();
  HorizontalJacobian by_slip_ = HorizontalJacobian::Zero();
  HorizontalJacobian felt_ = HorizontalJacobian::Identity();
  Matrix2X slope_;                  // of the force at this instant, for every column
  std::array<Matrix2X, 2> before_;  // of the two instants before
};

template <class Evaluate>
bool SoleShear::Solve(const Evaluate& evaluate, Horizontal& velocity) const {
  constexpr int kSteps = 300;
  constexpr double kSettled = 1e-10;  // [m/s]: one more step is exact
  constexpr double kLeast = 1e-6;     // of the largest curvature, the least that a step is computed with
  constexpr double kDescent = 1e-4;   // of what the slope promises
  constexpr double kNoStep = 1e8;     // times the largest curvature
  struct Point {
    Horizontal gradient;
    HorizontalJacobian curvature;
    double value;
  };
  const auto at = [&](const Horizontal& w) -> Point {
    const Friction friction = evaluate(w);
    return {w - compliance_ * ForceRate(friction.force),
            HorizontalJacobian::Identity() - (compliance_ * now_) * friction.by_slip,
            0.5 * w.squaredNorm() + compliance_ * (now_ * friction.potential + Past().dot(w))};
  };
  velocity = velocity_;
  Point point = at(velocity);
  double damping = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double size = point.gradient.norm();
    const auto [least, most] = Curvatures(point.curvature);
    const bool convex = least > 0;
    if (convex && size <= kSettled * most) {
      velocity -= Inverse(point.curvature) * point.gradient;  // to rounding
      return true;
    }
    const double added = convex ? damping : std::max(damping, kLeast * most - 2 * least);
    const Horizontal step =
        -(Inverse(point.curvature + added * HorizontalJacobian::Identity()) * point.gradient);
    const Point trial = at(velocity + step);
    // Near the minimum the function's change is rounding, and its slope is not.
    const bool lower = trial.value <= point.value + kDescent * point.gradient.dot(step) ||
                       (convex && trial.gradient.norm() < 0.5 * size);
    if (!lower) {
      if (damping > kNoStep * most) return size <= 10 * kSettled * most;
      damping = std::max(4 * damping, 0.1 * most);
      continue;
    }
    damping = damping > 1e-2 * most ? 0.1 * damping : 0;
    velocity += step;
    point = trial;
  }
  return false;
}

}  // namespace sinew
