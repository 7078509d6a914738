// What a curve looks like, in words.
#pragma once

#include <string>

#include "identify/diagnosis/diagnosis.h"

namespace sinew::text {

/// "odd, with a step at zero", "periodic, about every 2.1", "no simple shape"; empty if nothing is known.
[[nodiscard]] std::string ShapeText(const Shape& shape);

/// Known law of that shape for this signal: "Coulomb friction", "quadratic drag", ...; may be empty.
[[nodiscard]] std::string LawText(const Shape& shape, const std::string& signal);

/// Of any unknown term: a curve's shape, "grows within a trial", "1.6 Hz".
[[nodiscard]] std::string ShapeText(const UnknownFinding& unknown);

/// Of a curve; else empty.
[[nodiscard]] std::string LawText(const UnknownFinding& unknown);

}  // namespace sinew::text
