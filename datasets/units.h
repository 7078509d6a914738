// Units at the border: whatever a file says is converted to SI when it is read.
#pragma once

#include <string>
#include <string_view>

#include "base/error.h"

namespace sinew {

/// A value in the written unit times `factor`, plus `offset`, is the value in the SI unit.
struct UnitConversion {
  std::string si_unit;  ///< as sinew writes it: m, s, rad, N, N*m, N/m3, m/s, rad/s, V, A, kg, K, 1, ...
  double factor = 1;    ///< also of differences, such as a noise level
  double offset = 0;    ///< [SI unit] of degC, where the scale does not begin at 0

  [[nodiscard]] double ToSi(double value) const {
    return offset == 0 ? value * factor : value * factor + offset;
  }
};

/// Reads SI units, mm, cm, deg, deg/s, ms, N*mm, rpm, mV, uV, %, and products and quotients as they are
/// usually written (N*m, N m, Nm, m/s, m/s^2, m/s2, N*m/(rad/s)); degC alone. Every spelling of a unit gives
/// the same `si_unit`: symbols in a fixed order, N*m*s/rad. Errors: an unknown unit; the message lists the
/// known ones.
Result<UnitConversion> ToSi(std::string_view unit);

}  // namespace sinew
