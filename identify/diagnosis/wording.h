// The diagnosis in sentences.
#pragma once

#include <string>
#include <vector>

#include "identify/diagnosis/diagnosis.h"

namespace sinew {

/// "command_delay = 0.182 s +-0.003"; several joined by commas.
[[nodiscard]] std::string DescribeParameters(const std::vector<DiagnosedParameter>& parameters);

/// The sentences of a finished diagnosis: headline and findings, the most important first.
[[nodiscard]] std::vector<std::string> DescribeDiagnosis(const Diagnosis& diagnosis, bool has_held_out);

}  // namespace sinew
