// Formatting of numbers for people, and whole numbers out of files.
#pragma once

#include <optional>
#include <string>

namespace sinew {

/// Three significant digits by default: "8.97e5", "106", "0.0123", "-2.1"; "nan" and "inf" as such.
[[nodiscard]] std::string Readable(double value, int digits = 3);

/// The number as an integer; nothing if it is no whole number, or beyond 2^53, where doubles skip some.
[[nodiscard]] std::optional<long> WholeNumber(double value);

}  // namespace sinew
