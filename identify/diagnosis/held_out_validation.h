// Step 6, first half: validation of the causes on the held-out trials.
#pragma once

#include <vector>

#include "identify/diagnosis/diagnosis_state.h"

namespace sinew::diagnosis {

/// Removes from the selection every cause that makes the prediction of the held-out trials worse; if an
/// alternative of its set generalises, it takes its place. Causes that compensate each other can each look
/// necessary and be wrong together, so the whole set is also compared with the base model; if it is worse,
/// causes are removed in the order of their contribution, the smallest first.
/// What remains can still generalise less than it should. If the causes change held-out trials by a trace of
/// squared length d^2 (whitened), and the training trials by one of D^2, the expected reduction of the
/// squared error on held-out trials is N(d^2, 4 (1 + d^2 / D^2) d^2), from their own noise and that of the
/// fit. A far smaller reduction shows that the causes compensate for something else
/// (Selection::structure_left).
/// Errors: those of Problem::Predict on the held-out trials.
Result<std::vector<WithdrawnCause>> RejectUnsupportedCauses(DiagnosisState& state);

}  // namespace sinew::diagnosis
