// A muscle's EMG without its noise: what the electrode of another one records.
#pragma once

#include <vector>

#include "models/emg/shape_basis.h"
#include "problems/emg_shape/learning/cycle_scatter.h"

namespace sinew {

/// One curve for all recordings, a gain and a timing for each of them, and one for each of their bursts,
/// drawn to 0 by what is usual: a curve per recording would hold the noise of its few cycles, which is no
/// less than what distinguishes the EMG of one muscle from that of another. Alternately: gains and timings by
/// Gauss-Newton, the curve by least squares, weighted by the noise where the EMG then is.
/// @param recordings each with two cycles or more @param basis [recordings] as the envelopes' filter shows
/// the curve there, all of the same knots @param scatter of the same recordings @param correlated samples
/// @return [recordings][N]. Errors: those of FitShape.
Result<std::vector<std::vector<double>>> CleanEmg(const std::vector<CycleSamples>& recordings,
                                                  const std::vector<ShapeBasis>& basis,
                                                  const CycleScatter& scatter, double correlated);

}  // namespace sinew
