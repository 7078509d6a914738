// Noise of the measured force or torque that drives a joint. Where nothing feeds the position back, its
// integral is a random walk of the predicted speed, whose error is many times the noise of the position
// sensor.
#pragma once

#include <vector>

namespace sinew {

/// Noise of one record, and how it was taken out.
struct InputNoise {
  double level = 0;   ///< [unit of the input] standard deviation
  double cutoff = 0;  ///< [cycles per sample] above which the record was smoothed; 0: nowhere
};

/// Smooths white noise of a stated level away where the record holds nothing else, because what is fitted
/// depends on the same noise as the errors of the prediction do (errors in variables; Soderstrom 2007,
/// Automatica 43:939-958), most at high frequencies. The cut-off is the lowest one of a ladder (factor 0.8)
/// above which no band holds more than twice the power of the noise. The level has to be stated: what a
/// controller applies from sample to sample looks like noise, and is known exactly.
/// @param time [K, s, increasing] smoothed only if evenly spaced within 1 % @param values [K] replaced; as
/// they are where their variance above a quarter of the sampling rate differs from the stated one by half
/// @param stated [unit of the values] > 0
[[nodiscard]] InputNoise SmoothInput(const std::vector<double>& time, std::vector<double>& values,
                                     double stated);

/// Low-pass without a shift of phase: a sinc windowed by two cosines (Blackman). Beyond its ends the signal
/// goes on point-symmetrically. @param cutoff [cycles per sample, in (0, 0.5)]
[[nodiscard]] std::vector<double> LowPass(const std::vector<double>& values, double cutoff);

}  // namespace sinew
