// Butterworth filters by the bilinear transformation, as second-order sections.
//
//   analogue   |H(w)|^2 = 1 / (1 + w^(2n)),  poles on the unit circle, s^2 + 2 sin((2k + 1) pi / 2n) s + 1
//   digital    s = (z - 1) / (z + 1),  cut-offs at w = tan(pi f / rate), so that they stay where they belong
//
// Source: Butterworth, S. 1930, On the theory of filter amplifiers, Wireless Engineer 7, 536; Oppenheim,
// Schafer 2010, Discrete-Time Signal Processing, section 7.2. Same filters as scipy.signal.butter.
#pragma once

#include "base/error.h"
#include "models/emg/filter_section.h"

namespace sinew {

constexpr int kHighestFilterOrder = 16;  // of one pass; higher orders are not used in practice

/// Of one pass at the cut-off: amplitude 1 / sqrt(2) (-3 dB); far above, 6 dB per octave and order.
///
/// @param order number of poles [1..16] @param cut_off_Hz [Hz, from 1e-5 of the rate to below half of it]
/// @param rate_Hz of the samples [Hz, > 0]
/// @return sections with gain 1 at 0 Hz. Errors: a number outside of its range; the message states it.
/// At cut-offs below 1e-3 of the rate the coefficients' rounding shows: relative errors of the gain are
/// about 1e-17 (rate / cut-off)^2.
Result<FilterSections> ButterworthLowPass(int order, double cut_off_Hz, double rate_Hz);

/// As ButterworthLowPass; gain 1 at half of the rate and none at 0 Hz.
Result<FilterSections> ButterworthHighPass(int order, double cut_off_Hz, double rate_Hz);

/// @param order number of poles at each of both edges, as scipy counts it: 2 * order in all [1..16]
/// @param low_Hz @param high_Hz edges, amplitude 1 / sqrt(2) [Hz, ranges as a cut-off's, low < high]
Result<FilterSections> ButterworthBandPass(int order, double low_Hz, double high_Hz, double rate_Hz);

}  // namespace sinew
