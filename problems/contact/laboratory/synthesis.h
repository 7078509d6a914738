// A laboratory experiment that never happened: a small humanoid robot steps, its markers and the force under
// its foot are recorded. Synthetic, and marked so.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "datasets/dataset.h"
#include "problems/synthesis_request.h"

namespace sinew {

/// Stances of nao_like.osim, each a trial `train_1`, ..., `validate_1`, ... with one foot on one plate
/// (`right` or `left` in turn): markers and plate at 60 Hz, the .osim, and contact.yaml. The truth is not in
/// the data.
///
/// What the laboratory does to the signals follows the thesis (ch. 5): plates measure at 960 Hz with noise,
/// the export keeps every 16th sample, nothing is filtered; markers have noise of their own. The simulated
/// truth has a motion that is known 960 times a second and a sole of 36 x 20 squares; the model that
/// contact.yaml describes has 12 x 7 and samples the motion 60 times a second. Hidden effects (`--effect`,
/// ReadContactTruth) act in that truth and on the readings of its plates; nothing in the data names them.
/// Errors: unknown settings or effects (with a suggestion), values out of range.
Result<Dataset> SynthesizeContact(const SynthesisRequest& request);

/// Name and default of everything that `--set` takes.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> ContactExperiment();

}  // namespace sinew
