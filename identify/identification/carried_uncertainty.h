// What the errors of values that earlier steps found add to those of a step that holds them.
//
//   covariance = V + S C S',  S = -(J'J)^-1 J'H
//
// V of the step with the held values known, C of the held values, J and H the Jacobians of the step's
// residuals for its own and for the held values. Source: Murphy, Topel (1985), J. Bus. Econ. Stat. 3:370-379,
// with steps that share no data.
#pragma once

#include <vector>

#include "base/linear_algebra.h"
#include "identify/identification/identification.h"

namespace sinew {

/// The errors of everything that the steps so far have found.
struct CarriedErrors {
  std::vector<int> parameters;  ///< indices into Problem::parameters(), increasing
  Matrix covariance;            ///< [k x k] in the variables of the unit box
};

/// Widens errors and intervals of a finished step by those of the values that it holds, and takes its own
/// over. Parameters whose data determine nothing carry no error, because the step could not use what is not
/// known.
/// @param view the problem as the step saw it @param fit its result, usable
/// Errors: no prediction at the solution.
Status CarryErrors(const Problem& view, Identification& fit, CarriedErrors& carried);

}  // namespace sinew
