// Something periodic in time, such as the hum of a motor: a line in the spectrum of the residual. An
// autoregression would take it for colour of the noise.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/least_squares.h"

namespace sinew::noise {

struct SpectralLine {
  std::string channel;
  double frequency = 0;  ///< [Hz]
  /// Chance of a line so strong anywhere in the spectra, if they are smooth: bounded by the number of
  /// frequencies times the chance at one.
  double p_value = 1;
  /// Its chance at its own frequency as a chi-squared of two degrees.
  double statistic = 0;
};

/// Strongest line over all channels: power of all training blocks of a channel (Hann window, Welch 1967 for
/// the sum) at one frequency against that of its neighbours. Blocks with gaps, with uneven samples (2 %) or
/// fewer than 64 of them are left out; frequencies below 4 cycles per block too.
/// @param residual [m] weighted rows of the training blocks
[[nodiscard]] std::optional<SpectralLine> FindLine(const LeastSquares& fit, const Vector& residual);

/// Amplitudes [cosine, sine] of a line in the training residuals of its channel, by least squares; weighted.
[[nodiscard]] Vector LineAmplitudes(const LeastSquares& fit, const Vector& residual,
                                    const SpectralLine& line);

/// The line at a block's samples.
[[nodiscard]] Vector LineAt(const Block& block, const SpectralLine& line, const Vector& amplitudes);

}  // namespace sinew::noise
