#include "datasets/io/cells.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text.h"

namespace sinew {

std::optional<double> ParseSample(std::string_view cell) {
  constexpr double kGap = std::numeric_limits<double>::quiet_NaN();
  cell = Trim(cell);
  if (cell.empty() || cell == "NA") return kGap;
  const auto number = ParseNumber(cell);
  if (number) {
    if (std::isinf(*number)) return std::nullopt;
    return number;
  }
  if (cell.find("#IND") != std::string_view::npos || cell.find("#QNAN") != std::string_view::npos)
    return kGap;
  return std::nullopt;
}

int DecimalPlaces(std::string_view number) {
  number = Trim(number);
  const auto exponent_at = number.find_first_of("eE");
  const long exponent =
      exponent_at == std::string_view::npos ? 0 : ParseInteger(number.substr(exponent_at + 1)).value_or(0);
  const std::string_view digits = number.substr(0, exponent_at);
  const auto point = digits.find('.');
  long places = 0;
  if (point != std::string_view::npos) {
    const auto last = digits.find_last_not_of('0');
    places = static_cast<long>(last - point);  // 0 when only the point is left
  }
  constexpr long kMaximum = 400;  // beyond the resolution of a double
  return static_cast<int>(std::clamp(places - std::clamp(exponent, -kMaximum, kMaximum), 0L, kMaximum));
}

std::string Quoted(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string shown(text.substr(0, kLongest));
  for (char& c : shown) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f) c = '?';
  }
  return "'" + shown + (text.size() > kLongest ? "...'" : "'");
}

}  // namespace sinew
