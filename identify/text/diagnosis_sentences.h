// What a diagnosis found, in sentences.
#pragma once

#include <string>
#include <vector>

#include "identify/diagnosis/diagnosis.h"
#include "identify/text/sentence.h"

namespace sinew::text {

/// Verdict and findings, the most important first.
[[nodiscard]] std::vector<Sentence> Sentences(const Diagnosis& diagnosis);

/// One line for who only asks whether there is an answer; empty if there is one.
[[nodiscard]] std::string WhyInconclusive(const Diagnosis& diagnosis);

/// What the diagnosis does now: "fitting the base model".
[[nodiscard]] std::string ProgressText(const DiagnosisProgress& progress);

}  // namespace sinew::text
