// The jackknife over trials or parts of them: standard errors for models whose residual is mostly misfit, not
// noise.
#pragma once

#include "identify/diagnosis/fit/refit.h"

namespace sinew::diagnosis {

/// Covariance of the variables [n x n, unit box] by the jackknife that deletes one fold at a time (Tukey
/// 1958), scaled by Student's t for the number of folds so that 1.96 standard deviations are a 95 % interval.
/// Errors: no training trial, or a refit that fails.
Result<Matrix> JackknifeCovariance(const Problem& problem, const Refit& refit, int threads = 1);

}  // namespace sinew::diagnosis
