// Step 6, first half: whether the causes that fitted trials suggest generalise to held-out trials.
#pragma once

#include <vector>

#include "identify/diagnosis/examination.h"

namespace sinew::diagnosis {

/// A cause that makes held-out trials worse is withdrawn from the selection; if another one of its set
/// generalises, that takes its place. Causes that depend on each other may each look needed and be wrong
/// together: then all are compared with the base model, and the one whose removal costs least goes first.
/// What is left may still generalise less than it should: where the causes change held-out trials by a trace
/// of squared length d^2 (whitened), and the fitted trials by one of D^2, held-out trials should be missed by
/// N(d^2, 4 (1 + d^2 / D^2) d^2) less, their own noise and that of the fit together; far less says that the
/// causes stand in for something else.
/// Errors: the problem's own on the held-out trials.
Result<std::vector<WithdrawnCause>> RejectUnsupportedCauses(Examination& examination);

}  // namespace sinew::diagnosis
