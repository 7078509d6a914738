// The ankle on the dynamometer as a laboratory would record it. Synthetic, and marked so.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "datasets/dataset.h"
#include "problems/synthesis_request.h"

namespace sinew {

/// The attachment alone, passive rotations, and contractions against an isokinetic machine at six speeds;
/// two more speeds are held out. The truth is that of SimulateLaboratory, with noise of the instruments; it
/// is not in the data, except that with `--set hidden_truth=1` channels true_* hold what passed between
/// person and machine, for checking. With `--set exact=1` torques are those of the fitted model, without
/// noise. Errors: unknown settings or effects (with a suggestion), values out of range.
Result<Dataset> SynthesizeAnkle(const SynthesisRequest& request);

/// What --set takes besides the parameters.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> AnkleExperiment();

}  // namespace sinew
