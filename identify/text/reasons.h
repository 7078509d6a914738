// Why a parameter has its verdict, and what would help, in words.
#pragma once

#include <string>

#include "identify/uncertainty/uncertainty.h"

namespace sinew::text {

/// One sentence without a full stop: "the 95 % interval is +-3 % of the value". @param parameter that it is
/// about, with the bounds of the fit
[[nodiscard]] std::string ReasonText(const Parameter& parameter, const ParameterVerdict& verdict);

/// "measuring force_x would determine it (std. error 0.03 N)"; empty if nothing is needed.
/// @param figures false: without the standard errors, which differ from parameter to parameter
[[nodiscard]] std::string RemedyText(const Parameter& parameter, const Remedy& remedy, bool figures = true);

/// "mass up by 10 % with gravity down by 10 % leaves every residual unchanged".
[[nodiscard]] std::string DirectionText(const OpenDirection& direction);

}  // namespace sinew::text
