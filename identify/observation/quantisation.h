// Detection of quantisation: whether measured values are multiples of a step.
#pragma once

#include <optional>
#include <vector>

namespace sinew {

/// The largest step of which 99 % of the values (zeros aside) are multiples, within 2 % of the step, so that
/// a quantisation is found although values were printed with few digits. Empty if there is none: continuous
/// values, fewer than 20 values, fewer than 4 different ones (a switch), a step below 1e-6 of the largest
/// value (rounding of stored numbers), or values so sparse that hardly any two are within 12 steps of each
/// other.
///
/// A quantisation whose levels do not include zero (a constant was subtracted from the rounded reading) is
/// found by passing the values minus any one of them. Values printed with a fixed number of decimals are
/// quantised too, and are reported.
/// @param values [N, any unit, finite] in any order @return [unit of the values]
[[nodiscard]] std::optional<double> QuantisationStep(const std::vector<double>& values);

}  // namespace sinew
