// Step 7: errors that no effect of the library explains: a curve of one signal, a parameter that drifts, a
// line in the spectrum.
#pragma once

#include <vector>

#include "identify/diagnosis/diagnosis_state.h"

namespace sinew::diagnosis {

/// Fits the discrepancy terms that are significant after the selection, on top of its causes, most
/// significant first; terms that make the held-out trials worse are left out. The first one that does not
/// becomes part of the extended model: a curve changes `extended_point`, anything else fills
/// `DiagnosisState::added`. Errors: those of Problem::Predict.
Status DiscoverUnknown(DiagnosisState& state, Diagnosis& diagnosis);

}  // namespace sinew::diagnosis
