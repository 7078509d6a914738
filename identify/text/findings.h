// What an identification found, in sentences.
#pragma once

#include <string>
#include <vector>

#include "identify/identification/identification.h"
#include "identify/text/sentence.h"

namespace sinew::text {

/// What was determined and what was not and why, how well training and validation trials are predicted, and
/// which bounds were hit; the earlier steps of a stepwise fit first, with their names.
[[nodiscard]] std::vector<Sentence> Findings(const Identification& identification);

/// What a figure means and, of a parameter of a prior, where its value comes from.
[[nodiscard]] std::string Meaning(const FigureOfMerit& figure);

}  // namespace sinew::text
