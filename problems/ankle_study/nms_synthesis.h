// The ankle study as data. Synthetic, and marked so.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "datasets/dataset.h"
#include "identify/parameter.h"
#include "problems/synthesis_request.h"

namespace sinew {

/// One trial per speed, with raw EMG, excitations, lengths, moment arms, angle and moment; subject.xml (the
/// generic person) and nms.yaml. The true person differs; the truth is not in the data.
///
/// The truth is simulated at 1000 frames a second with the excitations as they were; the data have the
/// moments at 100 Hz, with noise, and excitations from the envelope of the raw EMG, which is noise that was
/// modulated. With `--set exact=1` moments
/// are those of the fitted model, without noise, and excitations are the true ones.
/// Errors: unknown settings or effects (with a suggestion), values out of range; no equilibrium of a tendon.
Result<Dataset> SynthesizeNms(const SynthesisRequest& request);

/// Name and default of everything that `--set` takes.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> NmsExperiment();

/// The parameters of the ankle study with their default ranges, without data.
[[nodiscard]] std::vector<Parameter> DefaultNmsParameters();

}  // namespace sinew
