// Whether measured values were rounded to multiples of a step.
#pragma once

#include <optional>
#include <vector>

namespace sinew {

/// The largest step of which 99 % of the values (zeros aside) are multiples, within 2 % of the step (so that
/// a lattice survives being printed with few digits). Nothing if there is none: continuous values, fewer than
/// 20 values, fewer than 4 different ones (a switch), a step below 1e-6 of the largest value (that is how
/// numbers are stored), or values so sparse that hardly any two are within 12 steps of each other.
///
/// A lattice that does not pass through zero (a rounded reading from which a constant was taken afterwards)
/// is found by passing the values minus any one of them. Values printed with a fixed number of decimals are
/// on a lattice too, and it is found.
/// @param values [N, any unit, finite] in any order @return [unit of the values]
[[nodiscard]] std::optional<double> QuantisationStep(const std::vector<double>& values);

}  // namespace sinew
