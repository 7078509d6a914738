// Fits that are done one after the other, as Problem::steps() lists them.
#pragma once

#include "base/error.h"
#include "identify/identification/identification.h"

namespace sinew {

/// Every step begins where the one before it ended, and holds what its predecessors found unless it frees it
/// again. What is reported is the last step's, with the moments, or whatever is measured, of all: its errors
/// contain those of the held values (CarryErrors). What the earlier steps found stands in
/// Identification::steps; their warnings stand in front, with the step's name.
/// @param request what a step would free beyond `free`, or what is fixed, stays where it is.
/// Errors: those of MakeFitSetup; a problem without steps; a step that has nothing to fit; an effect to
/// release: a step frees base parameters.
Result<Identification> IdentifyStepwise(const Problem& problem, const FitRequest& request,
                                        const IdentificationOptions& options);

}  // namespace sinew
