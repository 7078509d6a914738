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

/// beta1 and beta2 of the filter. Its two poles can be exchanged without any change; what follows describes
/// them by their mean and by the square of half of their distance, in which the filter is smooth even where
/// both are equal.
template <class T>
struct FilterCoefficients {
  T beta1{0.0};
  T beta2{0.0};
};

/// From C1, C2 = mean +- (1 + mean) sqrt(spread), which belong to one sampling rate.
/// @param mean (-1..0] @param spread [0..1)
template <class T>
[[nodiscard]] FilterCoefficients<T> FilterOfCoefficients(const T& mean, const T& spread) {
  return {2.0 * mean, mean * mean - (1.0 + mean) * (1.0 + mean) * spread};
}

/// cosh(sqrt(x)) for x >= 0, and its smooth continuation.
[[nodiscard]] double CoshOfRoot(double x, double& slope);

/// From poles that decay at the rates (1 + sqrt(spread)) / time and (1 - sqrt(spread)) / time, whatever the
/// sampling rate. @param time [s, > 0] @param spread [0..1) @param step [s, > 0] between samples
template <class T>
[[nodiscard]] FilterCoefficients<T> FilterOfTimes(const T& time, const T& spread, double step) {
  const T share = step / time;
  const T square = share * share * spread;
  double slope = 0;
  const double cosh = CoshOfRoot(Value(square), slope);
  const T decay = Exp(-share);
  return {-2.0 * decay * (cosh + slope * (square - Value(square))), decay * decay};
}

/// Lead of the filter of FilterOfTimes over its poles, because it uses each sample at once instead of the
/// line between samples: if its output is read later by this lead, it does not depend on the sampling rate,
/// to the second order in the step. @return [s], about one step
template <class T>
[[nodiscard]] T FilterLead(const T& time, double step) {
  return 2.0 * (time - step / (Exp(step / time) - 1.0));
}

/// The filter with its two last values. Stable for poles within the unit circle.
template <class T>
class ExcitationFilter {
 public:
  explicit ExcitationFilter(const FilterCoefficients<T>& coefficients)
      : beta1_(coefficients.beta1), beta2_(coefficients.beta2), alpha_(1.0 + beta1_ + beta2_) {}

  /// As after a long time of this excitation. @param excitation [0..1]
  void Settle(const T& excitation) { last_ = before_ = excitation; }

  /// @return neural activation
  T Next(const T& excitation) {
    const T u = alpha_ * excitation - beta1_ * last_ - beta2_ * before_;
    before_ = last_;
    last_ = u;
    return u;
  }

  /// Reproduces CEINMS, which stores its state twice per frame where it computes fibre lengths: of the two
  /// last values the older one is lost.
  void DropPreviousState() { before_ = last_; }

 private:
  T beta1_;
  T beta2_;
  T alpha_;
  T last_{0.0};
  T before_{0.0};
};

}  // namespace sinew
