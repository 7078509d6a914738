// The thesis's experiment of chapter 6 as data: an ankle on a dynamometer at six speeds. Synthetic, and
// marked so.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "datasets/dataset.h"
#include "identify/parameter.h"
#include "problems/synthesis_request.h"

namespace sinew {

/// One person: per speed a trial train_S of nine cycles and a trial validate_S of three, each with raw EMG of
/// five muscles at 2048 Hz, its normalised envelopes, the angle, and for the nms problem lengths, moment arms
/// and the moment (of seven muscles, two of them without electrodes, and of the machine's own inertia and
/// push); subject.xml, nms.yaml and emg_shape.yaml. With `--set exact=1` envelopes are those of the fitted
/// model itself. Errors: unknown settings or effects (with a suggestion), values out of range; no equilibrium
/// of a tendon.
Result<Dataset> SynthesizeEmgShape(const SynthesisRequest& request);

/// Name and default of everything that `--set` takes.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> EmgShapeExperiment();

/// The parameters of the made-up study, without data.
[[nodiscard]] std::vector<Parameter> DefaultEmgShapeParameters();

}  // namespace sinew
