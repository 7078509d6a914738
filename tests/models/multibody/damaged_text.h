// Texts with random damage, for tests of readers.
#pragma once

#include <string>

#include "base/random.h"

namespace sinew {

/// One or two bytes changed, added or taken away, or a piece of the text put elsewhere; the bytes are those
/// that matter to XML and to numbers, so that damage gets past the XML parser.
inline std::string Damaged(std::string text, Random& random) {
  const std::string bytes = "<>/\"= 0123456789-.eE\n\tanidxyz\xff";
  const auto changes = 1 + random.Index(2);
  for (std::uint64_t i = 0; i < changes; ++i) {
    const auto at = static_cast<std::size_t>(random.Index(text.size()));
    const char byte = bytes[random.Index(bytes.size())];
    switch (random.Index(4)) {
      case 0:
        text.insert(at, 1, byte);
        break;
      case 1:
        text.erase(at, 1 + random.Index(4));
        break;
      case 2:
        text.insert(at, text.substr(random.Index(text.size()), 40));
        break;
      default:
        text[at] = byte;
    }
  }
  return text;
}

}  // namespace sinew
