// What a problem reports beside its parameters: functions of them, and figures of merit of its own field.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/linear_algebra.h"

namespace sinew {

/// A function of parameters in which the field states its results, where the fit needs others: the filter
/// coefficients C1 and C2 of a muscle, of which mean and distance are fitted.
struct DerivedQuantity {
  std::string name;
  std::string unit;             ///< SI; "1" if it has none
  std::string meaning;          ///< one phrase
  std::vector<int> parameters;  ///< that it depends on, increasing
  /// Its value at parameters [P]; within the bounds of `parameters` monotonic in each of them.
  std::function<double(const Vector& parameters)> value;
};

/// Where the value of a parameter of a prior (ParameterKind::kPrior) comes from, which no least squares fits.
enum class PriorSource {
  kNone,         ///< not such a parameter, or one that is not for the data to tell
  kHeld,         ///< the request holds it
  kChosen,       ///< by the marginal likelihood
  kUndetermined  ///< no fit comes near enough to the noise to choose by
};

/// A number by which the field judges a fit.
struct FigureOfMerit {
  std::string name;     ///< "CEINMS's f"
  std::string meaning;  ///< one phrase, with unit unless it has none
  double value = 0;
  int parameter = -1;  ///< whose value it is, if it is that of a parameter of a prior
  PriorSource source = PriorSource::kNone;
};

}  // namespace sinew
