// From excitation to activation: a recursive filter of second order and a shape. SCIENCE section 3.
//
//   neural   u_k = alpha e_k - beta1 u_{k-1} - beta2 u_{k-2},  beta1 = C1 + C2, beta2 = C1 C2,
//            alpha = 1 + beta1 + beta2, so that a constant excitation passes    (Lloyd, Besier 2003)
//   shape    a = (exp(A u) - 1) / (exp(A) - 1)                                  (thesis eq 4.1, corrected)
#pragma once

#include <cmath>

#include "base/dual.h"

namespace sinew {

/// Slopes come with the value so that every kind of number can use them.
struct ShapeValue {
  double activation = 0;
  double by_excitation = 0;  ///< slope for u
  double by_shape = 0;       ///< slope for A
};

/// Exponential shape: bent the more, the lower A; A = 0 is a straight line. Exact to rounding for every A.
/// @param u neural activation [0..1; larger and negative values go on smoothly] @param shape A [-5..0; any
/// finite value works]
[[nodiscard]] ShapeValue ExponentialShape(double u, double shape);

/// CEINMS's piecewise shape: p ln(b u + 1) up to a corner, straight from there to (1, 1).
/// @param shape A [0..0.12]; 0 is a straight line
[[nodiscard]] ShapeValue PiecewiseShape(double u, double shape);

enum class ActivationShape { kExponential, kPiecewise };

template <class T>
[[nodiscard]] T Shaped(ActivationShape kind, const T& u, const T& shape) {
  const bool exponential = kind == ActivationShape::kExponential;
  const ShapeValue at =
      exponential ? ExponentialShape(Value(u), Value(shape)) : PiecewiseShape(Value(u), Value(shape));
  return at.activation + at.by_excitation * (u - Value(u)) + at.by_shape * (shape - Value(shape));
}

/// The filter with its two last values. Stable for |C1| < 1, |C2| < 1.
template <class T>
class ExcitationFilter {
 public:
  ExcitationFilter(const T& c1, const T& c2)
      : beta1_(c1 + c2), beta2_(c1 * c2), alpha_(1.0 + beta1_ + beta2_) {}

  /// As after a long time of this excitation. @param excitation [0..1]
  void Settle(const T& excitation) { last_ = before_ = excitation; }

  /// @return neural activation
  T Next(const T& excitation) {
    const T u = alpha_ * excitation - beta1_ * last_ - beta2_ * before_;
    before_ = last_;
    last_ = u;
    return u;
  }

  /// CEINMS stores its state twice per frame where it prepares fibre lengths: of the two last values one is
  /// forgotten.
  void ForgetTheOneBefore() { before_ = last_; }

 private:
  T beta1_;
  T beta2_;
  T alpha_;
  T last_{0.0};
  T before_{0.0};
};

/// C of a pole with this time constant: exp(-step / time_constant) with a minus sign.
/// @param time_constant [s, > 0] @param step [s, > 0] between samples
template <class T>
[[nodiscard]] T CoefficientOf(const T& time_constant, double step) {
  return -Exp(-step / time_constant);
}

}  // namespace sinew
