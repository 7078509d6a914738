// The findings of a diagnosis as tables: causes, what could stand in their place, and the answer of every
// effect of the library.
#pragma once

#include "identify/diagnosis/examination.h"

namespace sinew::diagnosis {

/// Values and intervals of parameters in a refit; those that it does not free are left out. A parameter that
/// the data do not determine has a standard error and bounds of NaN.
/// @param covariance [n x n] of the refit's variables @param which [P indices]
[[nodiscard]] std::vector<DiagnosedParameter> ValuesOf(const Examination& examination, const Refit& refit,
                                                       const Matrix& covariance,
                                                       const std::vector<int>& which);

/// Parameters before and after, causes, alternatives, scores. A channel whose readings are rounded is found
/// here: that is certain without a test, and a cause if it makes more of the residual than a test that knew
/// where to look would just detect. Errors: the problem's own.
Status Tabulate(Examination& examination, Diagnosis& diagnosis);

/// Puts a score at its place, strongest first.
void Insert(EffectScore score, std::vector<EffectScore>& scores);

}  // namespace sinew::diagnosis
