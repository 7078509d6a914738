// Effects that would do to all fitted data what a named cause does: an offset of a controller's reference and
// one of its torque, say. They cannot be told apart, whether a search happened to fit them or not.
#pragma once

#include "base/error.h"
#include "identify/diagnosis/diagnosis_state.h"

namespace sinew::diagnosis {

/// Adds to Selection::rivals every known candidate that can take the place of one cause of the selection and
/// leave the predictions as they are.
///
/// The change of the predictions by a cause, at the final model, both to first order and whole, is compared
/// with the columns of each candidate, the other fitted parameters being allowed to change. Where less
/// than 14 % of its length is left (correlation above 0.99), the candidate takes the cause's place at the
/// values that follow, and all is fitted again from there, so that the search begins in the same minimum. It
/// is a rival if this fit is within SetWidth, as any rival; where causes were chosen by cross-validation, if
/// the predictions of both models differ by less than a twentieth of the residual (Rival::left_out is then
/// the ratio of the two residuals).
///
/// @pre state.selection.model is fitted. Errors: those of Problem::Predict at its point.
Status AddEquivalentEffects(DiagnosisState& state);

}  // namespace sinew::diagnosis
