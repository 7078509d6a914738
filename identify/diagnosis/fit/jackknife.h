// The jackknife over trials: standard errors for models whose residual is mostly misfit, not noise.
#pragma once

#include "identify/diagnosis/fit/refit.h"

namespace sinew::diagnosis {

/// Covariance of the variables [n x n, unit box] by the delete-one-trial jackknife (Tukey 1958), scaled by
/// Student's t for the number of trials so that 1.96 standard deviations are a 95 % interval. Errors: fewer
/// than two training trials, or a refit that fails.
Result<Matrix> JackknifeCovariance(const Problem& problem, const Refit& refit);

}  // namespace sinew::diagnosis
