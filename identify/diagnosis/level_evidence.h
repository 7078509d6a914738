// Which level (human, robot, boundary, sensor) is to blame: what the effects of each level alone explain.
#pragma once

#include "identify/diagnosis/diagnosis.h"
#include "identify/diagnosis/diagnosis_state.h"

namespace sinew::diagnosis {

/// Fills Diagnosis::levels, one for every level with an effect that may be named, after the causes are known.
///
/// By likelihood: the best effect of each level, and the best set of as many as there are causes and one
/// more, at most three, chosen by their joint score at the base model, are refitted in place of the causes;
/// the one with the least deviance at the price of kPerParameter per parameter stands for its level. By
/// cross-validation: the set of the level's effects alone with the least error of left-out data, among those
/// that the search has judged.
///
/// A level is kBlamed if a cause is of it, kPossible if an alternative to a cause is of it, or if it explains
/// the error alone as well as the causes do (SetWidth).
///
/// @param state with the final selection @param diagnosis with its causes and alternatives
/// Nothing is filled in where nothing was found. Refits that fail count as explaining nothing.
void WeighLevels(const DiagnosisState& state, Diagnosis& diagnosis);

}  // namespace sinew::diagnosis
