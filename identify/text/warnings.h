// What limits a result, in sentences.
#pragma once

#include <string>
#include <vector>

#include "identify/diagnosis/diagnosis.h"
#include "identify/identification/identification.h"

namespace sinew::text {

/// One each, without a full stop, in the order of Identification::warnings.
[[nodiscard]] std::vector<std::string> Warnings(const Identification& identification);

/// The same, of Diagnosis::warnings.
[[nodiscard]] std::vector<std::string> Warnings(const Diagnosis& diagnosis);

/// The same, of a result that has nothing else.
[[nodiscard]] std::vector<std::string> Warnings(const std::vector<Warning>& warnings);

}  // namespace sinew::text
