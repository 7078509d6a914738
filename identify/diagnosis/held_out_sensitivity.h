// What the errors of the fitted values change on held-out trials.
#pragma once

#include <vector>

#include "base/error.h"
#include "base/linear_algebra.h"
#include "identify/diagnosis/fit/refit.h"
#include "identify/diagnosis/held_out_gain.h"
#include "identify/problem.h"

namespace sinew::diagnosis {

/// Changes of the weighted held-out residuals by one standard deviation of each independent combination of
/// the fitted values, to first order: J S with S S' their covariance [rows x k], blocks one below
/// the other. Where small differences of states grow, these are many times the noise, although the training
/// trials determine the values well.
/// @param held_out its blocks, and below them the rows of its priors @param fitted [P] the refit's point with
/// the held-out trials' own nuisance values fitted to them @param covariance of the refit's variables
/// @param nuisance [rows x h] is set to the columns of the held-out trials' own nuisance values,
/// which are fitted to them
/// Errors: those of Problem::Predict.
[[nodiscard]] Result<Matrix> HeldOutSensitivity(const Problem& problem, const HeldOut& held_out,
                                                const Refit& refit, const Vector& fitted,
                                                const Matrix& covariance, Matrix& nuisance);

/// -2 log of the normal density of whitened residuals whose covariance is 1 + A A', without constants.
/// @param changes A [n x k], whitened
[[nodiscard]] double PredictiveDeviance(const Vector& residual, const Matrix& changes);

}  // namespace sinew::diagnosis
