// Formatting of numbers for people.
#pragma once

#include <string>

namespace sinew {

/// Three significant digits by default: "8.97e5", "106", "0.0123", "-2.1"; "nan" and "inf" as such.
[[nodiscard]] std::string Readable(double value, int digits = 3);

}  // namespace sinew
