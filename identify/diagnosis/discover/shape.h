// Classification of the shape of a curve.
#pragma once

#include <string>
#include <vector>

namespace sinew {

/// The laws that a curve y(x) is compared with; c is the largest |x|.
enum class ShapeKind {
  kNone,           ///< too few values to tell, or a constant
  kLinear,         ///< x
  kQuadraticOdd,   ///< x |x|
  kCubic,          ///< x^3
  kQuadraticEven,  ///< x^2
  kStep,           ///< sign x
  kSaturating,     ///< tanh(x / 0.1 c) or tanh(x / 0.25 c)
  kPeak,           ///< sign x exp(-(x / 0.1 c)^2), or of width 0.25 c
  kPeriodic        ///< sine and cosine of `period`
};

/// "none", "linear", "quadratic_odd", ...: `shape_kind` in JSON and HDF5.
[[nodiscard]] const char* ToString(ShapeKind kind);

/// The law nearest to a curve, and how much of the curve's variance it explains.
struct Shape {
  ShapeKind kind = ShapeKind::kNone;
  double explained = 0;  ///< share of the curve's variance about its mean
  double period = 0;     ///< [unit of the signal] kPeriodic

  /// The law describes the curve well enough to be named.
  [[nodiscard]] bool simple() const { return kind != ShapeKind::kNone && explained >= kSimple; }
  static constexpr double kSimple = 0.85;
};

namespace diagnosis {

/// @param knots, curve [K] values at the knots @param weight [K] how sure each value is (1 / variance); may
/// be empty
[[nodiscard]] Shape FindShape(const std::vector<double>& knots, const std::vector<double>& curve,
                              const std::vector<double>& weight);

}  // namespace diagnosis
}  // namespace sinew
