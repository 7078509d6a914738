// What machines read of a diagnosis: schema sinew.diagnosis/1 (docs/diagnosis.md).
#pragma once

#include <string>

#include "identify/diagnosis/diagnosis.h"
#include "identify/files/run_file.h"

namespace sinew::files {

/// What became of an effect or unknown term: "cause", "alternative", "withdrawn", "unknown_term" (found),
/// "not_judged", or "ruled_out" (judged, and none of these).
[[nodiscard]] const char* FindingOf(const Diagnosis& diagnosis, const EffectScore& score);

/// JSON of `diagnose`. Numbers that are not finite are null; so are the interval of a parameter
/// that is not determined, and the gain without held-out trials.
[[nodiscard]] std::string DiagnosisJson(const Diagnosis& diagnosis, const Provenance& provenance,
                                        const DiagnosisOptions& options);

}  // namespace sinew::files
