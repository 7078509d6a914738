// Step 7: what is wrong and in no library: a curve of one signal, a parameter that drifts, a line in the
// spectrum.
#pragma once

#include <vector>

#include "identify/diagnosis/examination.h"

namespace sinew::diagnosis {

/// Fits the unknown terms that the selection left, on top of its causes, strongest first; those that make the
/// held-out trials worse are left out. The first one that does not becomes part of the extended model: a
/// curve moves `extended_point`, anything else fills `examination.added`. Errors: the problem's own.
Status DiscoverUnknown(Examination& examination, Diagnosis& diagnosis);

}  // namespace sinew::diagnosis
