#include "identify/statistics/student_t.h"

#include <cmath>
#include <initializer_list>
#include <limits>

#include "base/constants.h"

namespace sinew::statistics {
namespace {

// Above this the two leading terms of the expansion about the normal distribution are exact to 1e-9, and the
// difference of two large log-gamma values is not.
constexpr double kNearlyNormal = 1e5;

double NormalCdf(double z) {
  return 0.5 * std::erfc(-z / std::sqrt(2.0));
}
double NormalDensity(double z) {
  return std::exp(-0.5 * z * z) / std::sqrt(2 * kPi);
}

/// Continued fraction of the incomplete beta function, modified Lentz (Thompson, Barnett 1986).
double BetaFraction(double a, double b, double x) {
  constexpr int kMaxTerms = 1000;
  constexpr double kTiny = 1e-300;
  double c = 1;
  double d = 1 - (a + b) * x / (a + 1);
  d = 1 / (std::abs(d) < kTiny ? kTiny : d);
  double fraction = d;
  for (int m = 1; m <= kMaxTerms; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    double change = 1;
    for (const double term : {even, odd}) {
      d = 1 + term * d;
      d = 1 / (std::abs(d) < kTiny ? kTiny : d);
      c = 1 + term / c;
      if (std::abs(c) < kTiny) c = kTiny;
      change = c * d;
      fraction *= change;
    }
    if (std::abs(change - 1) < std::numeric_limits<double>::epsilon()) break;
  }
  return fraction;
}

/// Regularised incomplete beta function I_x(a, b).
double IncompleteBeta(double a, double b, double x) {
  if (x <= 0) return 0;
  if (x >= 1) return 1;
  const double front =
      std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
  if (x < (a + 1) / (a + b + 2)) return front * BetaFraction(a, b, x) / a;
  return 1 - front * BetaFraction(b, a, 1 - x) / b;
}

double Density(double t, double dof) {
  if (dof > kNearlyNormal) return NormalDensity(t);
  return std::exp(std::lgamma((dof + 1) / 2) - std::lgamma(dof / 2) -
                  (dof + 1) / 2 * std::log1p(t * t / dof)) /
         std::sqrt(dof * kPi);
}

/// Quantile for probability > 1/2 by Newton's iteration safeguarded by a bracket.
double UpperQuantile(double probability, double dof) {
  double lower = 0;
  double upper = 1;
  while (StudentTCdf(upper, dof) < probability && upper < 1e300) {
    lower = upper;
    upper *= 2;
  }
  double t = 0.5 * (lower + upper);
  constexpr int kMaxIterations = 200;  // bisection alone needs about 60
  for (int i = 0; i < kMaxIterations; ++i) {
    const double excess = StudentTCdf(t, dof) - probability;
    (excess < 0 ? lower : upper) = t;
    double next = t - excess / Density(t, dof);
    if (!(next > lower && next < upper)) next = 0.5 * (lower + upper);
    if (std::abs(next - t) <= 4 * std::numeric_limits<double>::epsilon() * t) return next;
    t = next;
  }
  return t;
}

}  // namespace

double StudentTCdf(double t, double degrees_of_freedom) {
  if (degrees_of_freedom > kNearlyNormal) {
    // Abramowitz, Stegun 26.7.8.
    const double z = t * (1 - 1 / (4 * degrees_of_freedom)) / std::sqrt(1 + t * t / (2 * degrees_of_freedom));
    return NormalCdf(z);
  }
  const double tail =
      0.5 * IncompleteBeta(degrees_of_freedom / 2, 0.5, degrees_of_freedom / (degrees_of_freedom + t * t));
  return t > 0 ? 1 - tail : tail;
}

double StudentTQuantile(double probability, double degrees_of_freedom) {
  if (!(probability > 0 && probability < 1 && degrees_of_freedom > 0)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  if (probability == 0.5) return 0;
  if (probability < 0.5) return -UpperQuantile(1 - probability, degrees_of_freedom);
  return UpperQuantile(probability, degrees_of_freedom);
}

double FUpperTail(double f, double first, double second) {
  return f > 0 ? IncompleteBeta(second / 2, first / 2, second / (second + first * f)) : 1;
}

}  // namespace sinew::statistics
