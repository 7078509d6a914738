// The noise level of a measured channel without any model: what differences of neighbouring samples leave
// where it is sampled much faster than it moves.
#pragma once

#include <optional>

#include "identify/layout.h"

namespace sinew::noise {

/// Fewest samples of a channel, without a gap, of which DifferenceNoise tells the noise.
inline constexpr int kSamplesForNoise = 22;

/// What differences of a measured signal show.
struct MeasuredNoise {
  double deviation = 0;  ///< [unit] standard deviation of white noise
  /// False: what is left of the differences is the signal itself, or what a filter, an interpolation or the
  /// rounding of stored numbers has left of the noise. `deviation` is then a lower limit that may be orders
  /// of magnitude too low.
  bool visible = false;
};

/// White noise on a measured channel, from its differences of second to sixth order, of which the smallest
/// estimate counts, because the signal itself is a part of all of them and a smaller part of the higher ones.
/// The estimate of an order is the median of the magnitudes (Hampel 1974), so that jumps and kinks do not
/// count. Never below the deviation of rounding to the channel's step. Of correlated noise this is the part
/// that changes from sample to sample, a lower limit; of noise known to be correlated (Block::noise_memory)
/// it says nothing.
///
/// Noise is visible, at whatever share of the signal, if the orders agree: a signal that is smooth between
/// samples leaves less in each higher order (a sine of w rad per sample about (w/2)^2 of the fourth in the
/// sixth), noise the same. Ratio of the sixth to the fourth order, median of 200 draws of 2000 samples: white
/// 1.00, autoregressive (0.98) 0.98, mean of five 0.98, first-order low-pass 0.80; Butterworth of second
/// order forwards and backwards, 0.5 and 0.25 of the Nyquist frequency: 0.57, 0.35; cubic spline through
/// every fourth sample 0.55; sine of 1 rad per sample 0.25. Below a millionth of the largest value only
/// rounding to a step counts, because numbers may have been stored with six digits. Source: Gasser, Sroka,
/// Jennen-Steinmetz (1986), Biometrika 73:625-633, for the second order.
/// @return nothing for fewer than kSamplesForNoise samples without a gap, and with a noise memory
[[nodiscard]] std::optional<MeasuredNoise> DifferenceNoise(const Block& block);

}  // namespace sinew::noise
