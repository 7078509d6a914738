// Envelope of raw EMG: high-pass, full-wave rectification, low-pass. SCIENCE section 3.
//
//   e = max(0, LP |HP raw|),  HP and LP Butterworth filters without lag (forward and backward)
//
// The high-pass removes the electrode's offset and movement artefacts, the low-pass all frequencies that
// muscle force cannot follow. Sources: Lloyd, Besier 2003, J. Biomech. 36, 765 (30 Hz, 6 Hz); Winter, D.
// 2009, Biomechanics and Motor Control of Human Movement, sections 3.4 and 10.2.
#pragma once

#include <cstddef>
#include <vector>

#include "base/error.h"
#include "models/emg/raw_emg.h"

namespace sinew {

struct EnvelopeSettings {
  double high_pass_Hz = 30;  ///< [Hz, below half of the sampling rate]
  double low_pass_Hz = 6;    ///< [Hz, below half of the sampling rate]
  /// Order of the filters, both passes together [2, 4, .. 16]. 4 is a Butterworth filter of order 2 run
  /// forward and backward, which biomechanics calls a zero-lag filter of fourth order (Winter 2009). 8 is
  /// scipy's `butter(4)` with `sosfiltfilt`. The cut-offs are those of the single pass: after both, the
  /// amplitude is 1/2 there (-6 dB), not 1 / sqrt(2); no cut-off is changed to compensate.
  int order = 4;
  double longest_gap_s = 0.05;  ///< samples that are missing for longer are an error [s, >= 0]
};

struct Envelope {
  std::vector<double> values;  ///< [N, unit of the signal, >= 0]
  double maximum = 0;          ///< of the values
  std::size_t maximum_at = 0;  ///< index of the first sample that has it
  std::size_t undershoot = 0;  ///< samples that the low-pass left below 0; they were set to 0
  double deepest = 0;          ///< the lowest of them before [unit of the signal, <= 0]
  RawEmgFaults faults;         ///< of the signal; its gaps were bridged
};

/// Errors: the order or the longest gap is outside of its range.
[[nodiscard]] Status CheckEnvelopeSettings(const EnvelopeSettings& settings);

/// A gap of up to longest_gap_s is bridged: the raw signal by a straight line, and the rectified signal there
/// by its mean over as long before and after, so that the envelope does not dip.
///
/// Both ends are scipy's (see FilterZeroLag): for about UnsettledSeconds the envelope there depends on the
/// first or last sample of the rectified signal, which is random. So compute envelopes first and cut trials
/// afterwards.
///
/// A constant signal has the envelope 0. Works in O(N).
/// @param raw [N, any unit; NaN where there is a gap] @param rate_Hz [Hz, > 0]
/// @return Errors: a setting outside of its range, a cut-off of half the rate or more, a signal shorter than
/// one period of a cut-off or than the filters need, a gap that is too long, no finite sample.
Result<Envelope> ComputeEnvelope(const std::vector<double>& raw, double rate_Hz,
                                 const EnvelopeSettings& settings);

/// How far the ends of an envelope depend on their single samples: half a period of the low-pass's cut-off.
[[nodiscard]] inline double UnsettledSeconds(const EnvelopeSettings& settings) {
  return 0.5 / settings.low_pass_Hz;
}

/// Amplitude that is left of a component of this frequency after both passes of the low-pass,
/// 1 / (1 + (f / cut-off)^order), as of the analogue filter [0..1].
[[nodiscard]] double LowPassAmplitude(const EnvelopeSettings& settings, double frequency_Hz);

}  // namespace sinew
