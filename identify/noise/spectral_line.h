// A spectral line: an error that is periodic in time, such as the hum of a motor. An autoregression would
// describe it as coloured noise.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/least_squares.h"

namespace sinew::noise {

struct SpectralLine {
  std::string channel;
  double frequency = 0;  ///< [Hz]
  /// Probability of a line so strong at any frequency if the spectra are smooth: bounded by the number of
  /// frequencies times the probability at one (Bonferroni).
  double p_value = 1;
  /// The significance at its own frequency as a chi-squared statistic with two degrees of freedom.
  double statistic = 0;
};

/// Strongest line over all channels: power of all training blocks of a channel (Hann window; sum over blocks
/// after Welch 1967) at one frequency against that of its neighbours. Left out are blocks with gaps, with
/// uneven samples (2 %) or with fewer than 64 of them, and frequencies below 4 cycles per block.
/// @param residual [m] weighted rows of the training blocks
[[nodiscard]] std::optional<SpectralLine> FindLine(const LeastSquares& fit, const Vector& residual);

/// Amplitudes [cosine, sine] of a line in the training residuals of its channel, by least squares; weighted.
[[nodiscard]] Vector LineAmplitudes(const LeastSquares& fit, const Vector& residual,
                                    const SpectralLine& line);

/// The line at a block's samples.
[[nodiscard]] Vector LineAt(const Block& block, const SpectralLine& line, const Vector& amplitudes);

}  // namespace sinew::noise
