#include "models/muscle/activation.h"

#include <algorithm>

namespace sinew {
namespace {

constexpr double kSmallShape = 1e-3;  // below, three terms of the series are exact to 1e-13
constexpr double kLargest = 500;      // exp stays finite

// CEINMS's corner, and the slope from there on.
constexpr double kCorner = 0.3085;
constexpr double kPerShape = 0.7071;
constexpr double kStraight = 1e-9;  // below, the curvature is less than rounding

// Slope of (1 - exp(-k)) / k.
double BendSlope(double k) {
  if (k < 1e-3) return -0.5 + k * (1.0 / 3 - k * (1.0 / 8 - k / 30));
  return (k * std::exp(-k) + std::expm1(-k)) / (k * k);
}

// k > 0 of (1 - exp(-k)) / k = ratio, by Newton's method from below: the left side is convex.
double SolveBend(double ratio) {
  double k = 2 * (1 - ratio);
  for (int i = 0; i < 50; ++i) {
    const double step = (-std::expm1(-k) / k - ratio) / BendSlope(k);
    k -= step;
    if (std::abs(step) < 1e-15 * k) break;
  }
  return k;
}

}  // namespace

double CoshOfRoot(double x, double& slope) {
  if (std::abs(x) < 1e-4) {
    slope = 0.5 + x * (1.0 / 12 + x / 240);
    return 1 + x * (0.5 + x * (1.0 / 24 + x / 720));
  }
  const double root = std::sqrt(std::abs(x));
  slope = 0.5 * (x > 0 ? std::sinh(root) : std::sin(root)) / root;
  return x > 0 ? std::cosh(root) : std::cos(root);
}

ShapeValue ExponentialShape(double u, double shape) {
  if (std::abs(shape) < kSmallShape) {
    // a = u + u (u - 1) / 2 A + u (u - 1) (2 u - 1) / 12 A^2 + u^2 (u - 1)^2 / 24 A^3 + ...
    const double first = u * (u - 1) / 2;
    const double second = u * (u - 1) * (2 * u - 1) / 12;
    const double third = u * u * (u - 1) * (u - 1) / 24;
    const double by_u = 1 + shape * ((2 * u - 1) / 2 + shape * (6 * u * (u - 1) + 1) / 12);
    return {u + shape * (first + shape * (second + shape * third)), by_u,
            first + shape * (2 * second + shape * 3 * third)};
  }
  const double bounded = std::clamp(shape, -kLargest, kLargest);
  const double argument = std::clamp(bounded * u, -kLargest, kLargest);
  const double bottom = std::expm1(bounded);
  const double top = std::expm1(argument);
  const double a = top / bottom;
  const double rise = std::exp(argument) / bottom;
  return {a, bounded * rise, u * rise - a * std::exp(bounded) / bottom};
}

// p ln(b u + 1) through the corner (x, y) with the slope m of the straight part: with k = y / p it is
// y ln(1 + (exp(k) - 1) u / x) / k, and (1 - exp(-k)) / k = m x / y.
ShapeValue PiecewiseShape(double u, double shape) {
  if (!(shape > kStraight)) return {u, 1, 0};
  const double x = kCorner - kPerShape * shape;
  const double y = kCorner + kPerShape * shape;
  const double dx = -kPerShape;
  const double dy = kPerShape;
  const double m = (1 - y) / (1 - x);
  const double dm = (m * dx - dy) / (1 - x);
  if (u >= x) return {1 + m * (u - 1), m, dm * (u - 1)};
  const double ratio = m * x / y;
  const double k = SolveBend(ratio);
  const double dk = ((dm * x + m * dx) / y - ratio * dy / y) / BendSlope(k);
  const double growth = std::expm1(k);
  // Below 0 the curve goes on as a straight line.
  const double z = std::max(u, 0.0) / x;
  const double dz = -z * dx / x;
  const double bent = std::log1p(growth * z) / k;
  const double by_z = growth / k / (1 + growth * z);
  const double by_k = ((growth + 1) * z / (1 + growth * z) - bent) / k;
  const double below = std::min(u, 0.0) / x;
  const double dbelow = -below * dx / x;
  const double slope_at_0 = growth / k;
  const double slope_by_k = ((growth + 1) - slope_at_0) / k;
  return {y * (bent + slope_at_0 * below), y * by_z / x,
          dy * (bent + slope_at_0 * below) +
              y * (by_k * dk + by_z * dz + slope_by_k * dk * below + slope_at_0 * dbelow)};
}

}  // namespace sinew
