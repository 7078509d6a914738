// Is a residual more than the noise that is visible at its own high frequencies? What a model lacks is as
// smooth as the motion; an error of a few times the noise is too small for MisfitScale, and a noise model
// absorbs it, so that the tests of a short recording may see nothing.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "identify/noise/noise_model.h"

namespace sinew::diagnosis {

/// Channels whose residual is more than 1.75 times its visible noise (noise::FindLowFrequencyExcess), and
/// that noise: its standard deviation [unit of the weighted residual]. Empty: no residual is more than noise.
/// (Noise of which half of the variance has a memory of many samples is 1.4 times what is visible.) Channels
/// with a noise memory (Block::noise_memory) are left out.
/// @param blocks residuals of the training blocks
[[nodiscard]] std::map<std::string, double> NoiseBelowMisfit(const std::vector<noise::NoiseBlock>& blocks);

/// A noise model with white noise of these levels in these channels.
[[nodiscard]] noise::NoiseModel WithVisibleNoise(noise::NoiseModel residual,
                                                 const std::map<std::string, double>& visible);

}  // namespace sinew::diagnosis
