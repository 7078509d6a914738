// The functions of <cmath> under their usual names for dual numbers too, so that a formula written for double
// compiles for both: sqrt(2 * kGravity * x). Comparisons are left out on purpose: say Value(a) < Value(b).
#pragma once

#include <algorithm>
#include <cmath>

#include "base/dual.h"

namespace sinew {

// For double they are the library's; named here so that code inside of this namespace finds them as well.
using std::abs;
using std::atan;
using std::atan2;
using std::cos;
using std::cosh;
using std::exp;
using std::fabs;
using std::hypot;
using std::log;
using std::max;
using std::min;
using std::pow;
using std::sin;
using std::sinh;
using std::sqrt;
using std::tan;
using std::tanh;

template <int N>
[[nodiscard]] Dual<N> sin(const Dual<N>& x) {
  return Sin(x);
}
template <int N>
[[nodiscard]] Dual<N> cos(const Dual<N>& x) {
  return Cos(x);
}
template <int N>
[[nodiscard]] Dual<N> tan(const Dual<N>& x) {
  const double t = std::tan(x.value);
  return Dual<N>::Chain(t, 1 + t * t, x);
}
template <int N>
[[nodiscard]] Dual<N> atan(const Dual<N>& x) {
  return Dual<N>::Chain(std::atan(x.value), 1 / (1 + x.value * x.value), x);
}
template <int N>
[[nodiscard]] Dual<N> exp(const Dual<N>& x) {
  return Exp(x);
}
template <int N>
[[nodiscard]] Dual<N> log(const Dual<N>& x) {
  return Log(x);
}
template <int N>
[[nodiscard]] Dual<N> sinh(const Dual<N>& x) {
  return Dual<N>::Chain(std::sinh(x.value), std::cosh(x.value), x);
}
template <int N>
[[nodiscard]] Dual<N> cosh(const Dual<N>& x) {
  return Dual<N>::Chain(std::cosh(x.value), std::sinh(x.value), x);
}
template <int N>
[[nodiscard]] Dual<N> tanh(const Dual<N>& x) {
  const double t = std::tanh(x.value);
  return Dual<N>::Chain(t, 1 - t * t, x);
}
/// At 0, where the slope is infinite, the derivatives are set to 0.
template <int N>
[[nodiscard]] Dual<N> sqrt(const Dual<N>& x) {
  const double root = std::sqrt(x.value);
  return Dual<N>::Chain(root, root == 0 ? 0 : 0.5 / root, x);
}
/// At 0 the slope is that to the right.
template <int N>
[[nodiscard]] Dual<N> abs(const Dual<N>& x) {
  return Abs(x);
}
template <int N>
[[nodiscard]] Dual<N> fabs(const Dual<N>& x) {
  return Abs(x);
}

/// x^y. Derivatives for a dual exponent need x > 0; at x = 0 they are set to 0.
template <int N>
[[nodiscard]] Dual<N> pow(const Dual<N>& x, double y) {
  return Dual<N>::Chain(std::pow(x.value, y), y == 0 ? 0 : y * std::pow(x.value, y - 1), x);
}
template <int N>
[[nodiscard]] Dual<N> pow(double x, const Dual<N>& y) {
  const double power = std::pow(x, y.value);
  return Dual<N>::Chain(power, x == 0 ? 0 : power * std::log(x), y);
}
template <int N>
[[nodiscard]] Dual<N> pow(const Dual<N>& x, const Dual<N>& y) {
  const double power = std::pow(x.value, y.value);
  Dual<N> r = Dual<N>::Chain(power, y.value == 0 ? 0 : y.value * std::pow(x.value, y.value - 1), x);
  r += Dual<N>::Chain(0, x.value == 0 ? 0 : power * std::log(x.value), y);
  return r;
}

template <int N>
[[nodiscard]] Dual<N> atan2(const Dual<N>& y, const Dual<N>& x) {
  const double squared = x.value * x.value + y.value * y.value;
  Dual<N> r = Dual<N>::Chain(std::atan2(y.value, x.value), x.value / squared, y);
  r -= Dual<N>::Chain(0, y.value / squared, x);
  return r;
}
template <int N>
[[nodiscard]] Dual<N> hypot(const Dual<N>& x, const Dual<N>& y) {
  return sqrt(x * x + y * y);
}

/// The larger one, with its derivatives; the first of two equal ones.
template <int N>
[[nodiscard]] Dual<N> max(const Dual<N>& a, const Dual<N>& b) {
  return a.value < b.value ? b : a;
}
template <int N>
[[nodiscard]] Dual<N> max(const Dual<N>& a, double b) {
  return a.value < b ? Dual<N>(b) : a;
}
template <int N>
[[nodiscard]] Dual<N> max(double a, const Dual<N>& b) {
  return a < b.value ? b : Dual<N>(a);
}
/// The smaller one, with its derivatives; the first of two equal ones.
template <int N>
[[nodiscard]] Dual<N> min(const Dual<N>& a, const Dual<N>& b) {
  return b.value < a.value ? b : a;
}
template <int N>
[[nodiscard]] Dual<N> min(const Dual<N>& a, double b) {
  return b < a.value ? Dual<N>(b) : a;
}
template <int N>
[[nodiscard]] Dual<N> min(double a, const Dual<N>& b) {
  return b.value < a ? b : Dual<N>(a);
}

/// x where it is above 0, else 0.
template <class T>
[[nodiscard]] T positive_part(const T& x) {
  return Value(x) > 0 ? x : T(0);
}

}  // namespace sinew
