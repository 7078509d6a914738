// Curves that the tests of this folder fit, with their gradients.
#pragma once

#include <cmath>

#include "tests/identify/support/toy_problem.h"

namespace sinew {

/// offset + slope t
inline Result<double> Line(const Block& /*block*/, double t, const Vector& p, Vector* gradient) {
  if (gradient != nullptr) {
    (*gradient)[0] = 1;
    (*gradient)[1] = t;
  }
  return p[0] + p[1] * t;
}

/// amplitude exp(-rate t)
inline Result<double> Decay(const Block& /*block*/, double t, const Vector& p, Vector* gradient) {
  const double shape = std::exp(-p[1] * t);
  if (gradient != nullptr) *gradient << shape, -p[0] * t * shape;
  return p[0] * shape;
}

/// cosine cos(w t) + sine sin(w t), three turns in two seconds
inline Result<double> Swing(const Block& /*block*/, double t, const Vector& p, Vector* gradient) {
  constexpr double kRate = 9.42477796;  // [rad/s]
  const double cosine = std::cos(kRate * t);
  const double sine = std::sin(kRate * t);
  if (gradient != nullptr) *gradient << cosine, sine;
  return p[0] * cosine + p[1] * sine;
}

}  // namespace sinew
