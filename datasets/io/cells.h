// Cells of a table of numbers: a number, a gap, or an error.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace sinew {

/// The number in a cell; NaN for a gap: an empty cell, "nan", "NA", or what Windows programs print for it
/// (-1.#IND). Nothing if it is text or infinite.
[[nodiscard]] std::optional<double> ParseSample(std::string_view cell);

/// Digits after the decimal point that count, without zeros at the end: 2 for "0.250", 5 for "2.5e-4", 0 for
/// "12".
[[nodiscard]] int DecimalPlaces(std::string_view number);

/// A piece of a file for a message: in quotes, shortened, without unprintable bytes.
[[nodiscard]] std::string Quoted(std::string_view text);

}  // namespace sinew
