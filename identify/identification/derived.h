// Values and 95 % intervals of what a problem derives from its parameters.
#pragma once

#include <string>
#include <vector>

#include "identify/fit_setup.h"
#include "identify/uncertainty/uncertainty.h"

namespace sinew {

/// A DerivedQuantity at the answer of a fit.
struct DerivedResult {
  std::string name;
  std::string unit;
  std::string meaning;
  std::vector<std::string> from;  ///< the fitted parameters that it depends on
  double value = 0;
  bool interval = false;  ///< false: no interval, because a parameter has none or lies outside its own
  double ci95_lower = 0;  ///< [unit]
  double ci95_upper = 0;
};

/// The derived quantities of a problem that depend on a free parameter.
///
/// Intervals follow from those of the parameters by the method of variance estimates recovery: the
/// differences of the quantity to its values at the ends of each parameter's interval, all others unchanged,
/// are combined as errors with the parameters' correlations (Zou, Donner 2008, Stat. Med. 27, 1693). For a
/// linear function and linear intervals this is error propagation; it also holds where the derivative at the
/// answer is infinite, as that of a root is at 0. Held parameters count as exact.
/// @param parameters [P] at the answer
[[nodiscard]] std::vector<DerivedResult> DeriveResults(const Problem& problem, const FitSetup& setup,
                                                       const Vector& parameters,
                                                       const Uncertainty& uncertainty);

}  // namespace sinew
