// The findings of a diagnosis as tables: causes, their alternatives, and the score of every effect of the
// library.
#pragma once

#include "identify/diagnosis/diagnosis_state.h"

namespace sinew::diagnosis {

/// Values and intervals of parameters in a refit; parameters that it does not free are left out. A parameter
/// that the data do not determine has a standard error and bounds of NaN.
/// @param covariance [n x n] of the refit's variables @param which [P indices]
[[nodiscard]] std::vector<DiagnosedParameter> ValuesOf(const DiagnosisState& state, const Refit& refit,
                                                       const Matrix& covariance,
                                                       const std::vector<int>& which);

/// Whether no interval of an effect's sizes excludes the value before, which is that without the effect. One
/// at a bound that is not this value excludes it; one that is not determined does not. False if there are
/// none.
[[nodiscard]] bool NoneExcludesNull(const std::vector<DiagnosedParameter>& sizes);

/// Fills in parameters before and after, causes, alternatives and scores. A quantised channel is added here:
/// it is recognised without a test, and it is a cause if its share of the residual exceeds the size that a
/// test of this effect alone detects. Errors: those of Problem::Predict.
Status Tabulate(DiagnosisState& state, Diagnosis& diagnosis);

/// Inserts a score at its place, most significant first.
void Insert(EffectScore score, std::vector<EffectScore>& scores);

}  // namespace sinew::diagnosis
