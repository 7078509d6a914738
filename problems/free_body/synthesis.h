// Made-up tosses of a cube.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "datasets/dataset.h"
#include "problems/synthesis_request.h"

namespace sinew {

/// Poses are those of the fitted model at a hundredth of its integrator's error, plus white noise of the
/// camera: the laboratory has no contact law that the model does not have. Every effect may be hidden in
/// them.
Result<Dataset> SynthesizeFreeBody(const SynthesisRequest& request);

/// What --set takes besides.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> FreeBodyExperiment();

}  // namespace sinew
