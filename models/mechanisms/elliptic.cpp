#include "models/mechanisms/elliptic.h"

#include <array>
#include <cmath>

#include "base/assert.h"
#include "base/constants.h"

namespace sinew {
namespace {

constexpr std::size_t kMaxSteps = 16;  // it converges quadratically

struct Mean {
  std::array<double, kMaxSteps + 1> a{}, c{};
  std::size_t steps = 0;
};

Mean ArithmeticGeometricMean(double m) {
  SINEW_ASSERT(m >= 0 && m < 1, "0 <= m < 1");
  Mean mean;
  mean.a[0] = 1;
  mean.c[0] = std::sqrt(m);
  double b = std::sqrt(1 - m);
  while (std::abs(mean.c[mean.steps]) > 1e-17 && mean.steps < kMaxSteps) {
    const double a = mean.a[mean.steps];
    ++mean.steps;
    mean.a[mean.steps] = (a + b) / 2;
    mean.c[mean.steps] = (a - b) / 2;
    b = std::sqrt(a * b);
  }
  return mean;
}

}  // namespace

double CompleteElliptic(double m) {
  const Mean mean = ArithmeticGeometricMean(m);
  return kPi / (2 * mean.a[mean.steps]);
}

JacobiElliptic JacobiEllipticAt(double u, double m) {
  const Mean mean = ArithmeticGeometricMean(m);
  double phi = std::ldexp(mean.a[mean.steps] * u, static_cast<int>(mean.steps));
  for (std::size_t i = mean.steps; i > 0; --i)
    phi = (phi + std::asin(mean.c[i] / mean.a[i] * std::sin(phi))) / 2;
  const double sn = std::sin(phi);
  return {sn, std::cos(phi), std::sqrt(1 - m * sn * sn)};
}

}  // namespace sinew
