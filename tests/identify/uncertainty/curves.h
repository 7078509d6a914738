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

}  // namespace sinew
