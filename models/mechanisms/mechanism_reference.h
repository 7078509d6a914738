// Reference paths of the mechanisms' points.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "models/mechanisms/mechanism.h"

namespace sinew {

/// One coordinate of one point.
struct ReferenceCurve {
  std::vector<double> time;    ///< [s]
  std::vector<double> values;  ///< in the mechanism's unit
};

struct MechanismReference {
  std::string source;                  ///< what it is and how it was made
  double certain_to = 0;               ///< its own uncertainty
  std::vector<ReferenceCurve> curves;  ///< [coordinates]
};

/// Built in: A01 and A02 in closed form (Jacobi's elliptic functions; A02 on the branch where windows stay
/// parallelograms), A03 to A05 converged runs of another integrator, A03-IVP the IVP test set.
/// @param windows of A02
[[nodiscard]] MechanismReference BuiltInReference(const Mechanism& mechanism, int windows = 40);

/// From a folder with NAME_reference_COORDINATE.csv or NAME_*_reference_COORDINATE.csv of columns
/// t_s,value_m. Errors: no such file, two, or a line that is not two numbers.
[[nodiscard]] Result<MechanismReference> ReadReference(const Mechanism& mechanism, const std::string& folder);

/// All times of all curves, once each, increasing; never below 0.
[[nodiscard]] std::vector<double> TimesOf(const MechanismReference& reference);

}  // namespace sinew
