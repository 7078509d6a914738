// How far a single measured EMG may be from its prediction.
#pragma once

#include <vector>

#include "base/error.h"
#include "problems/emg_shape/problem.h"

namespace sinew {

/// Standard deviations of single cycles about the prediction at `parameters`, per block of the layout [M].
///
///   variance = J C J' + f (noise^2 + gain_scatter^2 E^2 + timing_scatter^2 (dE/dphase)^2) + of the speed
///
/// C covariance of what was fitted (priors included, errors correlated over 0.08 s); E the EMG above its
/// floor; f the factor by which the cycles of this speed scatter more than the mean of all, from the fitted
/// trials; at speeds that were not fitted the largest f of its neighbours, and the scatter of speeds about
/// their laws is added. Empty if there is nothing fitted. O(samples parameters + parameters^3).
Result<std::vector<Vector>> PredictionBand(const EmgShapeProblem& problem, const Vector& parameters);

}  // namespace sinew
