// Steps 1 and 2: are the residuals noise, and if not, what do they go along with?
#pragma once

#include <vector>

#include "identify/diagnosis/diagnosis.h"
#include "identify/noise/noise_model.h"

namespace sinew::diagnosis {

/// Per channel: Ljung, Box 1978 over 20 lags, and the runs test of Wald, Wolfowitz 1940. They describe; they
/// raise no alarm, because coloured noise alone is no fault.
/// @param residuals [train blocks], as from NoiseBlocks
[[nodiscard]] std::vector<ResidualTest> TestResiduals(const std::vector<noise::NoiseBlock>& residuals);

/// For every fitted channel and every signal (time since the trial's begin, what the model predicts, and the
/// problem's own signals): the share of the residual's variance that a curve of 8 hats explains in trials
/// that it was not fitted to (each trial left out in turn; halves of the trial if there is only one).
/// Strongest first; shares below 1 % are left out.
/// @param point [P] where the residuals are taken. Errors: the problem's own.
Result<std::vector<Structure>> FindStructure(const Problem& problem, const Vector& point);

}  // namespace sinew::diagnosis
