#include "base/numbers.h"

#include <fmt/format.h>

#include <cmath>

namespace sinew {

std::string Readable(double value, int digits) {
  if (!std::isfinite(value)) return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
  if (value == 0) return "0";
  const int exponent = static_cast<int>(std::floor(std::log10(std::abs(value))));
  if (exponent >= -4 && exponent < 5)
    return fmt::format("{:.{}f}", value, std::max(0, digits - 1 - exponent));
  std::string text = fmt::format("{:.{}e}", value, digits - 1);
  // 8.97e+05 -> 8.97e5
  const auto at = text.find('e');
  std::string power = text.substr(at + 1);
  const bool negative = power[0] == '-';
  power.erase(0, 1);
  power.erase(0, power.find_first_not_of('0'));
  return text.substr(0, at) + "e" + (negative ? "-" : "") + power;
}

std::optional<long> WholeNumber(double value) {
  constexpr double kLargest = 9007199254740992.0;
  if (!(std::abs(value) <= kLargest) || std::floor(value) != value) return std::nullopt;
  return static_cast<long>(value);
}

}  // namespace sinew
