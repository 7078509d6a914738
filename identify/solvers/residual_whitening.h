// A fit's residuals, whitened: what drifts in a simulation counts little, what changes from sample to sample
// much.
#pragma once

#include <memory>

#include "identify/least_squares.h"

namespace sinew::solvers {

/// The whitening by an autoregression of order six per channel, of the residuals of the training blocks at a
/// point (Burg 1975). Beside a drift that nothing feeds back a ripple hardly lowers the plain cost, and that
/// cost has minima which this one does not have.
/// @param point [P] @return nothing if nothing can be predicted there, or if no residual is left
[[nodiscard]] std::unique_ptr<const RowTransform> ResidualWhitening(const LeastSquares& fit,
                                                                    const Vector& point);

}  // namespace sinew::solvers
