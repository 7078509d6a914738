// Intervals where the residual is not noise: what leaving out each trial does to the parameters.
#pragma once

#include "identify/diagnosis/fit/refit.h"

namespace sinew::diagnosis {

/// Covariance of the variables [n x n, unit box] by the delete-one-trial jackknife (Tukey 1958), already
/// widened by Student's t of so few trials, so that 1.96 standard deviations are 95 %. Errors: fewer than two
/// training trials, or a refit that fails.
Result<Matrix> JackknifeCovariance(const Problem& problem, const Refit& refit);

}  // namespace sinew::diagnosis
