// Steps 1 and 2: whiteness of the residuals, and their dependence on signals.
#pragma once

#include <vector>

#include "identify/diagnosis/diagnosis.h"
#include "identify/noise/noise_model.h"

namespace sinew::diagnosis {

/// Per channel the test of Ljung, Box 1978 over 20 lags and the runs test of Wald, Wolfowitz 1940. They
/// describe the residual and raise no alarm, because coloured noise alone is not an error of the model.
/// @param residuals [train blocks], as from NoiseBlocks
[[nodiscard]] std::vector<ResidualTest> TestResiduals(const std::vector<noise::NoiseBlock>& residuals);

/// For every fitted channel and every signal (time since the trial's begin, the predicted value, and the
/// problem's own signals): the share of the residual's variance that a curve of 8 linear basis functions
/// explains in trials that it was not fitted to (each trial left out in turn; halves of the trial if there is
/// only one). Strongest first; shares below 1 % are left out.
/// @param point [P] at which the residuals are taken. Errors: those of Problem::Predict.
Result<std::vector<Structure>> FindStructure(const Problem& problem, const Vector& point);

}  // namespace sinew::diagnosis
