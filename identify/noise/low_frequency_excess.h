// Is there more below some frequency in a residual than noise brings? What a model lacks is smooth between
// samples; noise is there at all frequencies, and its spectrum above tells how much of it is below.
#pragma once

#include <optional>
#include <vector>

#include "base/linear_algebra.h"

namespace sinew::noise {

/// Fewest samples of a stretch that takes part in FindLowFrequencyExcess.
inline constexpr int kSamplesForSpectrum = 64;

/// [unit of the residual]
struct LowFrequencyExcess {
  double deviation = 0;  ///< of the residual
  /// Of first-order autoregressive noise (white included) whose spectrum is that of the residual in an upper
  /// band: the largest one that the band allows (likelihood ratio, 99.9 %).
  double noise = 0;

  [[nodiscard]] double ratio() const { return deviation / noise; }
};

/// Fits a first-order autoregression to the upper seven eighths and to the upper three quarters of the
/// frequencies up to half the sampling rate, by the likelihood of independent squares of the discrete cosine
/// transform (Whittle 1953, Ark. Mat. 2:423-434; the cosine transform does not take a difference between both
/// ends for a jump), extrapolates them to all frequencies, and takes the smaller noise. (The wider band
/// bounds the memory of the noise better: 200 samples of white noise under a smooth error of 2.4 times its
/// size, by 1.4 times the noise instead of 11 times. The error may reach into it, above all in a short
/// record.)
///
/// A residual that is AR(1) noise with a memory of many samples is no excess: its upper band does not bound
/// the memory. Nor is one whose upper band is no such spectrum (low-pass filtered noise, a mean of several
/// samples, a line).
/// @param stretches residual without gaps, one per stretch, about evenly sampled
/// @return nothing without a stretch of kSamplesForSpectrum samples, and if the upper band is no such
/// spectrum
[[nodiscard]] std::optional<LowFrequencyExcess> FindLowFrequencyExcess(const std::vector<Vector>& stretches);

}  // namespace sinew::noise
