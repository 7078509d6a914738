// One step of the classical Runge-Kutta method of order 4 for the joint, and how instants within it are
// found.
#pragma once

#include <algorithm>
#include <cmath>

#include "models/drive/actuation.h"

namespace sinew {

/// The state at the end of a step.
template <class S>
struct DriveReached {
  S q;
  S v;
  double acceleration;  // at the step's begin
};

/// @param direction of slip, +1 or -1; 0 leaves dry friction out. @param t, h begin and length [s].
template <class S, class Time>
[[nodiscard]] DriveReached<S> DriveStep(const DriveActuation& actuation, const DriveDynamics<S>& dynamics,
                                        const DriveHeld<S>& held, double direction, const Time& t,
                                        const Time& h, const S& q, const S& v) {
  const auto acceleration = [&](const Time& at, const S& x, const S& dx) {
    return dynamics.Acceleration(direction, dx, actuation.LoadsAt(dynamics, held, at, x, dx));
  };
  const Time half = 0.5 * h;
  const Time middle = t + half;
  const auto after = [](const S& from, const Time& length, const S& slope) {
    S to = from;
    AddProduct(to, length, slope);
    return to;
  };
  // from + h / 6 (first + 2 (second + third) + fourth)
  const Time sixth = h * (1.0 / 6);
  const auto end = [&](const S& from, const S& first, const S& second, const S& third, const S& fourth) {
    S sum = first;
    AddProduct(sum, 2.0, second + third);
    sum += fourth;
    return after(from, sixth, sum);
  };
  const S k1 = acceleration(t, q, v);
  const S v2 = after(v, half, k1);
  const S k2 = acceleration(middle, after(q, half, v), v2);
  const S v3 = after(v, half, k2);
  const S k3 = acceleration(middle, after(q, half, v2), v3);
  const S v4 = after(v, h, k3);
  const S k4 = acceleration(t + h, after(q, h, v3), v4);
  return {end(q, v, v2, v3, v4), end(v, k1, k2, k3, k4), Value(k1)};
}

/// Where f turns from above 0 at `from` to below at `to`: regula falsi, Illinois variant, to rounding.
template <class F>
[[nodiscard]] double FallingRoot(double from, double to, F&& f) {
  constexpr int kMaxIterations = 100;
  constexpr double kRounding = 1e-15;
  double low = f(from);
  double high = f(to);
  const double enough = kRounding * std::max(std::abs(low), std::abs(high));
  double side = 0;
  for (int i = 0; i < kMaxIterations && to - from > kRounding * to; ++i) {
    double s = from + (to - from) * (low / (low - high));
    if (!(s > from && s < to)) s = 0.5 * (from + to);
    if (!(s > from && s < to)) break;
    const double value = f(s);
    if (value > 0) {
      from = s;
      low = value;
      if (side > 0) high *= 0.5;
      side = 1;
    } else {
      to = s;
      high = value;
      if (side < 0) low *= 0.5;
      side = -1;
    }
    if (std::abs(value) <= enough) return s;
  }
  return to;
}

}  // namespace sinew
