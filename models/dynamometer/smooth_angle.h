// A measured angle without its noise, so that its second derivative can be used.
#pragma once

#include <vector>

#include "base/error.h"

namespace sinew {

struct SmoothAngle {
  std::vector<double> values;  ///< [N]
  double cutoff = 0;           ///< [Hz]; 0: not filtered
};

/// Low-pass of second order, forwards and backwards. The cut-off is the one that generalised cross-validation
/// prefers among 2 to 40 Hz (Craven, Wahba 1979; for movements Woltring 1986), where the degrees of freedom
/// of a filter are the sum of its gains.
/// @param values [N, rad] @param rate [Hz] @param cutoff [Hz] the one to use; negative: by cross-validation;
/// 0: none. A cut-off above 0.4 of the rate does nothing. Errors: too few samples for the filter.
Result<SmoothAngle> SmoothedAngle(const std::vector<double>& values, double rate, double cutoff);

}  // namespace sinew
