// Error of a run against a reference.
#pragma once

#include <vector>

#include "models/mechanisms/mechanism_reference.h"
#include "models/mechanisms/mechanism_run.h"

namespace sinew {

struct MechanismError {
  double total = 0;          ///< equation 3.2 of the thesis, a share (not %)
  std::vector<double> rmse;  ///< [coordinates] in the mechanism's unit
  std::vector<double> peak;  ///< [coordinates]
};

/// e_j(t) = |y - reference| / max(|reference|, threshold), equation 3.1; total: the root of the mean over
/// coordinates of the mean over samples of its square. Gonzalez et al. 2006.
/// @param times [samples] of the run; those of the reference must be among them.
[[nodiscard]] MechanismError ErrorOf(const Mechanism& mechanism, const MechanismRun& run,
                                     const std::vector<double>& times, const MechanismReference& reference);

}  // namespace sinew
