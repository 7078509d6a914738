// Is a residual more than the noise that the data state, or that is visible at its own high frequencies? What
// a model lacks is as smooth as the motion; an error of a few times the noise is too small for MisfitScale,
// and a noise model absorbs it, so that the tests of a short recording may see nothing.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "identify/noise/noise_model.h"

namespace sinew::diagnosis {

/// Channels whose residual is more than its noise, and that noise: its standard deviation [unit of the
/// weighted residual]. Empty: no residual is more than noise. Channels with a noise memory
/// (Block::noise_memory) are left out.
///
/// A residual is more than noise if its deviation is more than 1.75 times its visible noise
/// (noise::FindLowFrequencyExcess; noise of which half of the variance has a memory of many samples is 1.4
/// times what is visible), or, where the data state a level in every block, if it is more than twice that
/// level and smooth: the autocorrelation of neighbours, from their mean square difference (von Neumann 1941,
/// Ann. Math. Stat. 12:367-395), is at least 0.3 and three standard errors. White noise above its stated
/// level is no misfit of the model: the level is stated too low.
/// @param blocks residuals of the training blocks
[[nodiscard]] std::map<std::string, double> NoiseBelowMisfit(const std::vector<noise::NoiseBlock>& blocks);

/// A noise model with white noise of these levels in these channels.
[[nodiscard]] noise::NoiseModel WithNoiseBelowMisfit(noise::NoiseModel residual,
                                                     const std::map<std::string, double>& visible);

}  // namespace sinew::diagnosis
