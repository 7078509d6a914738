// A diagnosis as text for a terminal.
#pragma once

#include <string>
#include <vector>

#include "identify/diagnosis/diagnosis.h"

namespace sinew::text {

/// One sentence or phrase, to be wrapped and indented by whoever prints it.
struct Line {
  int indent = 0;  ///< [columns]
  std::string text;
};

/// The sentences of the diagnosis, then the evidence for its causes, where the residual is, the base model,
/// what was ruled out and what was not judged, and the warnings.
[[nodiscard]] std::vector<Line> Overview(const Diagnosis& diagnosis);

}  // namespace sinew::text
