#include "base/printable.h"

#include <fmt/format.h>

#include <cstdint>

namespace sinew {
namespace {

struct Character {
  std::uint32_t code = 0;
  std::size_t bytes = 1;
  bool valid = false;
};

// The UTF-8 character that begins at this byte.
Character CharacterAt(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(at);
  if (first < 0x80) return {first, 1, true};
  const std::size_t bytes = first >= 0xf0 && first < 0xf5   ? 4
                            : first >= 0xe0 && first < 0xf0 ? 3
                            : first >= 0xc2 && first < 0xe0 ? 2
                                                            : 1;
  if (bytes == 1 || at + bytes > text.size()) return {first, 1, false};
  std::uint32_t code = first & (0x7fU >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(at + i) & 0xc0U) != 0x80) return {first, 1, false};
    code = code << 6 | (byte(at + i) & 0x3fU);
  }
  const bool overlong = code < (bytes == 4 ? 0x10000U : bytes == 3 ? 0x800U : 0x80U);
  const bool surrogate = code >= 0xd800 && code < 0xe000;
  if (overlong || surrogate || code > 0x10ffff) return {first, 1, false};
  return {code, bytes, true};
}

bool IsControl(std::uint32_t code) {
  return code < 0x20 || (code >= 0x7f && code < 0xa0);
}

bool ChangesDirection(std::uint32_t code) {
  return code == 0x061c || code == 0x200e || code == 0x200f || (code >= 0x2028 && code <= 0x202e) ||
         (code >= 0x2066 && code <= 0x2069);
}

template <class Escape>
std::string Replaced(std::string_view text, const Escape& escape) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const Character c = CharacterAt(text, at);
    const std::string instead =
        c.valid && !IsControl(c.code) && !ChangesDirection(c.code) ? std::string() : escape(c);
    out += instead.empty() ? std::string(text.substr(at, c.bytes)) : instead;
    at += c.bytes;
  }
  return out;
}

std::string Escaped(const Character& c) {
  return c.code < 0x100 ? fmt::format("\\x{:02x}", c.code) : fmt::format("\\u{:04x}", c.code);
}

}  // namespace

std::string Printable(std::string_view text) {
  return Replaced(text, [](const Character& c) { return c.code == '\n' ? std::string() : Escaped(c); });
}

std::string PrintableLine(std::string_view text) {
  return Replaced(text, [](const Character& c) {
    return c.code == '\n' ? std::string("\\n") : c.code == '\t' ? std::string("\\t") : Escaped(c);
  });
}

std::string PrintableJson(std::string_view json) {
  return Replaced(json, [](const Character& c) {
    // Those below a blank stand between values; inside of strings JSON has them escaped already.
    return c.valid && c.code >= 0x20 ? fmt::format("\\u{:04x}", c.code) : std::string();
  });
}

}  // namespace sinew
