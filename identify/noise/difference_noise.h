// The noise level of a measured channel without any model: what differences of neighbouring samples leave
// where it is sampled much faster than it moves.
#pragma once

#include <optional>

#include "identify/layout.h"

namespace sinew::noise {

/// Fewest samples of a channel, without a gap, of which DifferenceNoise tells the noise.
inline constexpr int kSamplesForNoise = 22;

/// Standard deviation of white noise on a measured channel [unit]: from its differences of second to sixth
/// order, of which the smallest estimate counts, because the signal itself is a part of all of them and a
/// smaller part of the higher ones. The estimate of an order is the median of the magnitudes (Hampel 1974),
/// so that jumps do not count. Never below the deviation of rounding to the channel's step. Of correlated
/// noise this is the part that changes from sample to sample, a lower limit; of noise known to be correlated
/// (Block::noise_memory) it says nothing.
/// Source: Gasser, Sroka, Jennen-Steinmetz (1986), Biometrika 73:625-633, for the second order.
/// @return nothing for fewer than kSamplesForNoise samples without a gap, and with a noise memory
[[nodiscard]] std::optional<double> DifferenceNoise(const Block& block);

}  // namespace sinew::noise
