// A diagnosis as text for a terminal.
#pragma once

#include <string>

#include "identify/diagnosis/diagnosis.h"

namespace sinew {

/// The diagnosis' own sentences, then how sure they are, where the residual is, the base model, what was
/// ruled out and what was not judged; indented by two, lines of at most 100 columns.
[[nodiscard]] std::string DiagnosisText(const Diagnosis& diagnosis);

}  // namespace sinew
