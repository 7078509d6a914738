// Step 6, first half: held-out trials may deny what fitted trials suggest.
#pragma once

#include <vector>

#include "identify/diagnosis/examination.h"

namespace sinew::diagnosis {

/// A cause that held-out trials deny is withdrawn from the selection; if another one of its set carries over,
/// that takes its place. Causes that lean on each other may each look needed and be wrong together: then the
/// whole is compared with the base model, and what is missed least goes first.
/// What is left may still not carry over as it should: where the causes change held-out trials by a trace of
/// squared length d^2 (whitened), and the fitted trials by one of D^2, held-out trials should be missed by
/// N(d^2, 4 (1 + d^2 / D^2) d^2) less, their own noise and that of the fit together; far less says that the
/// causes stand in for something else.
/// Errors: the problem's own on the held-out trials.
Result<std::vector<WithdrawnCause>> RejectUnsupportedCauses(Examination& examination);

}  // namespace sinew::diagnosis
