// What a diagnosis says of single effects, in phrases.
#pragma once

#include <string>
#include <vector>

#include "identify/diagnosis/diagnosis.h"

namespace sinew::text {

/// What the cause is: the effect's own description, or that a sensor rounds.
[[nodiscard]] std::string DescriptionOf(const Cause& cause);

/// Why a cause was withdrawn: "it does not generalise to the held-out trials: ...".
[[nodiscard]] std::string ReasonText(const WithdrawnCause& cause);

/// Why an effect was not judged; empty if it was.
[[nodiscard]] std::string ReasonText(NotJudged reason);

/// "stribeck_velocity = 0.05 rad/s"; empty at the null.
[[nodiscard]] std::string ProbeText(const std::vector<ProbeValue>& probe);

/// "stated by the data", "residual of the extended model".
[[nodiscard]] std::string BasisText(NoiseBasis basis);

/// "command_delay = 0.182 s +-0.003"; several joined by commas.
[[nodiscard]] std::string ParametersText(const std::vector<DiagnosedParameter>& parameters);

}  // namespace sinew::text
