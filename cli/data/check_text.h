// What a check of data found, in sentences.
#pragma once

#include <string>
#include <vector>

#include "datasets/check/finding.h"
#include "datasets/check/mask.h"

namespace sinew::text {

/// What was found, to stand within a line: without capital letter and full stop.
[[nodiscard]] std::string FindingPhrase(const Finding& finding);

/// What was found, where, when and how large, with a full stop.
[[nodiscard]] std::string FindingText(const Finding& finding);

/// What to do about it, with a full stop.
[[nodiscard]] std::string AdviceText(const Finding& finding);

/// "3 spans of right_force_y in trial 'walk' (1.2 s)"; empty if nothing is suggested.
[[nodiscard]] std::string MaskText(const std::vector<MaskedSpan>& mask);

}  // namespace sinew::text
