// The slope at the last sample of a spline through the samples so far, as weights of these samples: they
// depend on the times alone, so that a trial has them once and for all.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace sinew {

/// Of CEINMS's spline, which ends at the current frame.
constexpr std::size_t kSplinePoints = 15;

/// [N x kSplinePoints] row i: weights [1/s] of samples i - kSplinePoints + 1 .. i in the slope at sample i of
/// the spline (SplineSlopes) through them; 0 for samples before the first.
/// @param time [N, s, increasing]
[[nodiscard]] std::vector<double> SplineEndWeights(const std::vector<double>& time);

}  // namespace sinew
