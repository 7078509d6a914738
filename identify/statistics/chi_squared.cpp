#include "identify/statistics/chi_squared.h"

#include <cmath>
#include <limits>

namespace sinew::statistics {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
// Both expansions need some multiple of sqrt(a) terms near x = a: this is enough for a = 1e8.
constexpr int kMaxTerms = 200000;

/// log of x^a exp(-x) / gamma(a).
double LogFront(double a, double x) {
  return a * std::log(x) - x - std::lgamma(a);
}

/// Regularised lower incomplete gamma function P(a, x) by its series; for x < a + 1.
double LowerSeries(double a, double x) {
  double term = 1 / a;
  double sum = term;
  for (int n = 1; n < kMaxTerms && term > sum * kEpsilon; ++n) {
    term *= x / (a + n);
    sum += term;
  }
  return std::exp(LogFront(a, x)) * sum;
}

/// log Q(a, x) by its continued fraction, modified Lentz (Thompson, Barnett 1986); for x >= a + 1.
double LogUpperFraction(double a, double x) {
  constexpr double kTiny = 1e-300;
  double b = x + 1 - a;
  double c = 1 / kTiny;
  double d = 1 / b;
  double fraction = d;
  for (int n = 1; n < kMaxTerms; ++n) {
    const double numerator = -n * (n - a);
    b += 2;
    d = numerator * d + b;
    d = 1 / (std::abs(d) < kTiny ? kTiny : d);
    c = b + numerator / c;
    if (std::abs(c) < kTiny) c = kTiny;
    fraction *= c * d;
    if (std::abs(c * d - 1) < kEpsilon) break;
  }
  return LogFront(a, x) + std::log(fraction);
}

}  // namespace

double LogChiSquaredUpperTail(double x, double degrees_of_freedom) {
  if (!(x > 0)) return std::isnan(x) ? x : 0;
  if (std::isinf(x)) return -x;
  const double a = degrees_of_freedom / 2;
  return x / 2 < a + 1 ? std::log1p(-LowerSeries(a, x / 2)) : LogUpperFraction(a, x / 2);
}

double ChiSquaredUpperTail(double x, double degrees_of_freedom) {
  if (degrees_of_freedom == 1 && x > 0) return std::erfc(std::sqrt(x / 2));  // the usual case, and faster
  return std::exp(LogChiSquaredUpperTail(x, degrees_of_freedom));
}

double TwoSidedThreshold(double p) {
  if (!(p < 1)) return std::isnan(p) ? p : 0;
  if (!(p > 0)) return std::numeric_limits<double>::infinity();
  constexpr double kSqrtTwoOverPi = 0.79788456080286535588;
  const double target = std::log(p);
  // The logarithm of the tail is decreasing, concave, and below -z^2/2, so that Newton's iteration from above
  // converges monotonically.
  double z = std::sqrt(-2 * target);
  constexpr int kMaxIterations = 100;
  for (int i = 0; i < kMaxIterations; ++i) {
    const double tail = LogChiSquaredUpperTail(z * z, 1);
    const double hazard = kSqrtTwoOverPi * std::exp(-0.5 * z * z - tail);
    const double next = z + (tail - target) / hazard;
    if (!(next > 0)) return 0;
    if (std::abs(next - z) <= 4 * kEpsilon * z) return next;
    z = next;
  }
  return z;
}

}  // namespace sinew::statistics
