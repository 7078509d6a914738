// Noise of an envelope: EMG is noise that activation modulates, so its errors grow with it.
#pragma once

#include <vector>

namespace sinew {

// Errors of an envelope (6 Hz) are correlated over so many seconds.
constexpr double kEnvelopeCorrelated_s = 0.08;
// Of normalised EMG; made-up data without noise have a weight too.
constexpr double kMinEnvelopeNoise = 1e-4;

/// variance = quiet^2 + growth^2 EMG^2
struct ModulatedNoise {
  double quiet = 0;   ///< standard deviation where there is no EMG, >= 0
  double growth = 0;  ///< share of the EMG, >= 0

  [[nodiscard]] double At(double emg) const;
};

/// By the likelihood of normal errors: each square counts by its own variance. (Plain least squares on
/// squares leave what valleys have to the rounding errors of the bursts. With proportional errors of 8 %,
/// scores of a burst's shape then have two to three times the variance that they should have.)
/// @param squares [N >= 1] of the errors @param emg [N]
[[nodiscard]] ModulatedNoise FitModulatedNoise(const std::vector<double>& squares,
                                               const std::vector<double>& emg);

}  // namespace sinew
